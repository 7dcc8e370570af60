// Is this driver to be trusted? Each entry point exercises one thing that has gone wrong on some driver without an error.

struct Test {
    count: u32,
    loops: u32,
}

@group(0) @binding(0) var<uniform> test: Test;
// Pairs of arguments.
@group(0) @binding(1) var<storage, read> given: array<vec2<f32>>;
@group(0) @binding(2) var<storage, read_write> found: array<f32>;
@group(0) @binding(3) var<storage, read_write> counts: array<atomic<u32>>;

@compute @workgroup_size(WORKGROUP)
fn arithmetic(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= test.count {
        return;
    }
    let a = given[id.x].x;
    let b = given[id.x].y;
    write_results(id.x * RESULTS, a, b);
}

// Some drivers end an invocation after 65 535 iterations of its loops, without a word.
@compute @workgroup_size(1)
fn loops() {
    var iterations = 0u;
    var x = test.count;
    for (var i = 0u; i < test.loops; i++) {
        x = x * 1664525u + 1013904223u;
        iterations += 1u + (x & 0u);
    }
    atomicStore(&counts[0], iterations);
}

// Every invocation appends itself: each number must be there once.
@compute @workgroup_size(WORKGROUP)
fn append(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= test.count {
        return;
    }
    let at = atomicAdd(&counts[0], 1u);
    if at < test.count {
        atomicAdd(&counts[1u + id.x], 1u);
        found[at] = f32(id.x);
    }
}
