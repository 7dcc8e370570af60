// Sum, difference, product, quotient, root, then the own functions: the results of one pair of numbers, from place `at` on. The program
// writes this text again for f64.
fn write_results(at: u32, a: f32, b: f32) {
    found[at] = a + b;
    found[at + 1u] = a - b;
    found[at + 2u] = a * b;
    found[at + 3u] = a / b;
    found[at + 4u] = sqrt(abs(a));
    found[at + 5u] = exp_m1(a);
    found[at + 6u] = ln_1p(abs(a));
    found[at + 7u] = sine(a);
    found[at + 8u] = cosine(a);
    found[at + 9u] = arc_sine(a / (1.0 + abs(a)));
}
