// Volumes only count.
void main() {
}
