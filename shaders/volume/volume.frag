// Stencil only.
void main() {
}
