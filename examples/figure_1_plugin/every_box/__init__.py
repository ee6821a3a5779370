"""One module for each box of D2.1 Figure 1, none longer than 80 lines."""
