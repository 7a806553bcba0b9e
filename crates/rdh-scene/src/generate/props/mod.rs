//! Things that stand about. Each stands on z = 0, in metres, with its back towards +y if it has one; `r` is the
//! resolution of its round parts.

mod books;
mod furniture;
mod plants;
mod small;
mod soft;

pub(crate) use books::bookshelf;
pub(crate) use furniture::{chair, counter, desk, fridge, office_chair, round_table, table, wardrobe};
pub(crate) use plants::{Habit, bush, grass, plant, tree};
pub(crate) use small::{
    bin, blind, bowl, ceiling_lamp, cup, floor_lamp, keyboard, monitor, picture, plate, radiator, table_lamp, vase,
};
pub(crate) use soft::{armchair, bed, bedding, sofa};
