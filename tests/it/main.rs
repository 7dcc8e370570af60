//! Tests of the crate through its interfaces, in one binary.

/// Broken study files, each with the message that it must give.
mod bad_studies;
/// Sweeps by bounds compared with sweeps design by design.
mod bounds;
/// A browser for looking at pages.
mod browser;
/// The pulley as a model for CalculiX, and its solution compared with the harmonics.
mod calculix;
/// The catalogues that come with the program, searched for typing slips.
mod catalogues;
mod clamping;
/// The binary: exit codes, messages, files, interrupted runs.
mod command_line;
/// How many evaluations a test may make of a model.
mod effort;
/// The equations that are printed of a model, computed again.
mod equations;
/// A model with all elementary functions.
mod every_function;
/// The page of `beltspace explore`, in a browser.
mod explore_page;
/// The same: weights, trade-offs, what explains the feasible designs.
mod explore_page_choose;
/// The same: controls, and what is typed into them.
mod explore_page_controls;
/// The same, on screens of several sizes.
mod explore_page_laptop;
mod explore_page_pace;
/// What a result says besides its numbers, by brute force.
mod findings;
/// Studies with formulas, by brute force.
mod formulas;
/// Screening on a graphics device.
mod gpu;
/// Identities of the V-belt variator, and the tables of its paper.
mod identities;
/// Mangled files: reading them must not panic, hang or take all memory.
mod mutations;
/// The models over every number type: f32 with error bounds, intervals, dependencies, columns.
mod numbers;
/// A model made at run time.
mod own_model;
/// The pictures of pages in README and manual.
mod pages_in_docs;
/// The papers' figures and tables, computed again.
mod papers;
/// The models against their second implementation.
mod physics;
/// Random small studies, by brute force and by the pipeline.
mod pipeline;
/// Studies with distributions.
mod probability;
/// The loads on a V-belt pulley as vectors.
mod pulley_balance;
/// The stresses of a V-belt pulley against a converged reference.
mod pulley_fe;
/// Example pulleys.
mod pulleys;
/// A random number generator for seeded tests.
mod random;
/// The README and the manual, compared with what the program prints.
mod readme;
/// The page of a result, in a browser.
mod report_page;
/// The same: designs that come from a catalogue, many axes and many pins.
mod report_page_catalogues;
/// The same: weights, trade-offs, what explains the feasible designs.
mod report_page_choose;
/// The same: many points and lines, and what lies over what.
mod report_page_crowds;
/// The drive drawn to scale and the slices of the knee, on that page.
mod report_page_drawn;
/// Pages with the keyboard.
mod report_page_keys;
/// The page of a study with one objective.
mod report_page_one;
/// The same: other results over it.
mod report_page_others;
/// That page on paper.
mod report_page_print;
/// What that page lets a reader reach and save.
mod report_page_reach;
/// Independent second implementations of the models, and printed golden values.
mod second;
/// Which input matters: shares of the variance.
mod sensitivity;
/// `beltspace sensitivity` as people run it.
mod sensitivity_files;
/// Numbers that Rust and the shaders both know.
mod shader_constants;
/// The committed shaders against the formulas.
mod shaders;
/// Load spectra: means and sums over weighted cases.
mod spectra;
/// Tables of the program in a terminal of 80 columns.
mod terminal_width;
/// The timing belt: figures, closed forms, similarity.
mod timing_mesh;
/// The tutorials of `docs/`, run and compared with what the program prints.
mod tutorial;
/// Names of the crate's types.
mod type_names;
