//! What checks of structures find.

/// Something that is wrong with a structure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault(pub String);

/// A list of faults, cut off at 100: a broken structure has millions.
#[derive(Debug, Default)]
pub(crate) struct Faults(pub(crate) Vec<Fault>);

impl Faults {
    /// Adds a fault, while there is room.
    pub(crate) fn add(&mut self, what: String) {
        if self.0.len() < 100 {
            self.0.push(Fault(what));
        }
    }
}
