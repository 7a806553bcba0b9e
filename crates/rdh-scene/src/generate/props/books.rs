//! Shelves full of books.

use crate::generate::noise::Dice;
use crate::generate::place::{axes, stretch};
use crate::generate::shape::{Shape, block};
use crate::generate::vector::Point;
use crate::scene::Transform;

/// A bookcase, 1 m wide, 2.05 m high and 0.3 m deep, and its books: `fill` is how full its boards are, 0 to 1.
pub(crate) fn bookshelf(dice: &mut Dice, fill: f64) -> (Shape, Shape) {
    let mut case = block([-0.5, -0.15, 0.0], [-0.48, 0.15, 2.05]);
    case.block([0.48, -0.15, 0.0], [0.5, 0.15, 2.05]);
    case.block([-0.48, 0.135, 0.06], [0.48, 0.15, 2.03]);
    let mut books = Shape::default();
    for board in 0..7 {
        let z = if board == 6 { 2.03 } else { 0.06 + 0.33 * f64::from(board) };
        case.block([-0.48, -0.15, z - 0.02], [0.48, 0.135, z]);
        if board < 6 {
            row(&mut books, dice, z, fill);
        }
    }
    (case, books)
}

/// A row of books on a board, the last one leaning on its neighbour.
fn row(books: &mut Shape, dice: &mut Dice, z: f64, fill: f64) {
    let end = -0.47 + 0.94 * fill * dice.between(0.75, 1.0);
    let mut x = -0.47;
    while x < end {
        let size = [dice.between(0.012, 0.05), dice.between(0.14, 0.24), dice.between(0.18, 0.29)];
        if x + size[0] > 0.47 {
            return;
        }
        let back = dice.between(0.11, 0.13);
        books.append(&block([0.0; 3], size), &Transform::translation([x, back - size[1], z]));
        x += size[0] + 0.001;
    }
    if x < 0.3 {
        leaning(books, [x, -0.08, z], [0.025, 0.18, 0.25]);
    }
}

/// A book that leans to the left, with its lower right edge on the board.
fn leaning(books: &mut Shape, at: Point, size: Point) {
    let (sin, cos) = 14.0_f64.to_radians().sin_cos();
    // Its foot stands out so far that its upper left edge touches what is left of it.
    let foot = [at[0] + sin * size[2] + 0.001, at[1], at[2]];
    let lean = axes([cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos], foot);
    books.append(&block([0.0; 3], [1.0; 3]), &lean.after(&stretch(size)));
}
