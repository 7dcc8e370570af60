//! Tests of the crate as its users see it, in one binary.

/// Broken study files: each with the message it must give.
mod bad_studies;
/// The binary: exit codes, messages, files, interrupted runs.
mod command_line;
/// Random small studies, by brute force and by the pipeline.
mod pipeline;
/// A random number generator for seeded tests.
mod random;
/// Independent second implementations of the models, and printed golden values.
mod second;
