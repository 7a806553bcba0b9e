//! Every piece of furniture once, ready to be placed many times.

use crate::generate::noise::Dice;
use crate::generate::props;
use crate::generate::shape::block;
use crate::generate::stage::{Paint, Prop, Stage};
use crate::scene::Material;

/// How many different bookcases and plants there are.
const VARIANTS: usize = 6;

/// The pieces.
#[derive(Debug)]
pub(super) struct Kit {
    pub(super) table: Prop,
    pub(super) long_table: Prop,
    pub(super) low_table: Prop,
    pub(super) round_table: Prop,
    pub(super) desk: Prop,
    pub(super) chair: Prop,
    pub(super) office_chair: Prop,
    pub(super) sofa: Prop,
    pub(super) armchair: Prop,
    pub(super) bed: Prop,
    pub(super) bedding: Prop,
    pub(super) wardrobe: Prop,
    pub(super) counter: Prop,
    pub(super) fridge: Prop,
    pub(super) cases: [[Prop; 2]; VARIANTS],
    pub(super) plants: [[Prop; 2]; VARIANTS],
    pub(super) ceiling_lamp: Prop,
    pub(super) floor_lamp: Prop,
    pub(super) table_lamp: Prop,
    pub(super) plate: Prop,
    pub(super) bowl: Prop,
    pub(super) cup: Prop,
    pub(super) vase: Prop,
    pub(super) bin: Prop,
    pub(super) monitor: Prop,
    pub(super) keyboard: Prop,
    pub(super) radiator: Prop,
    pub(super) blind: Prop,
    pub(super) picture: Prop,
    pub(super) mirror: Prop,
    pub(super) rug: Prop,
    pub(super) bench: Prop,
    pub(super) door: Prop,
}

struct Paints {
    wood: Paint,
    cloth: Paint,
    metal: Paint,
    china: Paint,
    paper: Paint,
    glass: Paint,
    leaf: Paint,
    silver: Paint,
}

impl Paints {
    fn new(stage: &mut Stage) -> Self {
        let mut matte =
            |diffuse: f32, mirror: f32| stage.material(Material { diffuse, mirror, transmission: 0.0, index: 1.0 });
        Self {
            wood: matte(0.5, 0.0),
            cloth: matte(0.6, 0.0),
            metal: matte(0.4, 0.3),
            china: matte(0.75, 0.1),
            paper: matte(0.7, 0.0),
            leaf: matte(0.35, 0.0),
            silver: matte(0.05, 0.9),
            glass: stage.material(Material { diffuse: 0.05, mirror: 0.1, transmission: 0.8, index: 1.5 }),
        }
    }
}

impl Kit {
    pub(super) fn new(stage: &mut Stage, detail: u32, seed: u64) -> Self {
        let p = Paints::new(stage);
        let r = detail;
        let pairs = |stage: &mut Stage, i: usize, plant: bool| {
            let mut dice = Dice::new(seed, &[-1, i as i64, i64::from(plant)]);
            if plant {
                let (pot, green) = props::plant(14 + 4 * r, 2 * r, &mut dice);
                [stage.prop("pot", pot, p.china), stage.prop("plant", green, p.leaf)]
            } else {
                let (case, books) = props::bookshelf(&mut dice, 0.5 + 0.1 * i as f64);
                [stage.prop("bookcase", case, p.wood), stage.prop("books", books, p.paper)]
            }
        };
        let cases = std::array::from_fn(|i| pairs(stage, i, false));
        let plants = std::array::from_fn(|i| pairs(stage, i, true));
        let mut bench = block([-0.7, -0.2, 0.4], [0.7, 0.2, 0.45]);
        bench.block([-0.6, -0.15, 0.0], [-0.55, 0.15, 0.4]);
        bench.block([0.55, -0.15, 0.0], [0.6, 0.15, 0.4]);
        Self {
            table: stage.prop("table", props::table(1.4, 0.8, r), p.wood),
            long_table: stage.prop("long table", props::table(2.6, 1.1, r), p.wood),
            low_table: stage.prop("low table", lowered(props::table(1.0, 0.6, r)), p.wood),
            round_table: stage.prop("round table", props::round_table(0.55, 2 * r), p.wood),
            desk: stage.prop("desk", props::desk(r), p.wood),
            chair: stage.prop("chair", props::chair(r), p.wood),
            office_chair: stage.prop("office chair", props::office_chair(r), p.cloth),
            sofa: stage.prop("sofa", props::sofa(3, 2 * r), p.cloth),
            armchair: stage.prop("armchair", props::armchair(2 * r), p.cloth),
            bed: stage.prop("bed", props::bed(r), p.wood),
            bedding: stage.prop("bedding", props::bedding(2 * r), p.cloth),
            wardrobe: stage.prop("wardrobe", props::wardrobe(r), p.wood),
            counter: stage.prop("counter", props::counter(4, r), p.wood),
            fridge: stage.prop("fridge", props::fridge(r), p.metal),
            cases,
            plants,
            ceiling_lamp: stage.prop("ceiling lamp", props::ceiling_lamp(2 * r), p.china),
            floor_lamp: stage.prop("floor lamp", props::floor_lamp(2 * r), p.metal),
            table_lamp: stage.prop("table lamp", props::table_lamp(2 * r), p.china),
            plate: stage.prop("plate", props::plate(2 * r), p.china),
            bowl: stage.prop("bowl", props::bowl(2 * r), p.china),
            cup: stage.prop("cup", props::cup(2 * r), p.china),
            vase: stage.prop("vase", props::vase(3 * r), p.glass),
            bin: stage.prop("bin", props::bin(r), p.metal),
            monitor: stage.prop("monitor", props::monitor(r), p.metal),
            keyboard: stage.prop("keyboard", props::keyboard(), p.china),
            radiator: stage.prop("radiator", props::radiator(r), p.metal),
            blind: stage.prop("blind", props::blind(2.3, 0.7, 8 + 4 * r), p.metal),
            picture: stage.prop("picture", props::picture(0.7, 0.5), p.paper),
            mirror: stage.prop("mirror", props::picture(0.5, 1.2), p.silver),
            rug: stage.prop("rug", block([-1.1, -0.8, 0.0], [1.1, 0.8, 0.012]), p.cloth),
            bench: stage.prop("bench", bench, p.wood),
            door: stage.prop("door", super::fittings::door(r), p.wood),
        }
    }
}

/// A table cut down to a sofa's height.
fn lowered(mut table: crate::generate::shape::Shape) -> crate::generate::shape::Shape {
    for p in &mut table.positions {
        p[2] *= 0.55;
    }
    table
}
