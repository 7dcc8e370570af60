// One round of the shuffle that decides which feasible designs a sample takes: as `Shuffle` in src/reduce/sample.rs does it. A
// number has 64 bits, (low, high) words.
fn shuffled(number: vec2<u32>, key: u32) -> vec2<u32> {
    var mixed = number.x ^ key;
    mixed = (mixed ^ (mixed >> 16u)) * 0x21f0aaadu;
    mixed = (mixed ^ (mixed >> 15u)) * 0x735a2d97u;
    return vec2<u32>(number.y ^ mixed ^ (mixed >> 15u), number.x);
}
