//! The examples of the guide run.

#[path = "../examples/sunlight.rs"]
mod sunlight;

#[test]
fn sunlight() {
    sunlight::main().unwrap();
}
