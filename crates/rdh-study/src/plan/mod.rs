//! What is to be run, as plain data.

mod protocol;
mod source;
mod target;

use std::fmt::Display;

use rdh::{HeuristicSpec, RdhSpec, Spec};

use crate::error::{Error, Result};
use crate::integrate::Mode;

pub use protocol::Protocol;
pub use source::Source;
pub use target::Target;
pub(crate) use target::{find_view, path_view};

/// A study: targets × modes × specs. Everything that decides its counts is in here.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Which scenes, and which of their views.
    pub targets: Vec<Target>,
    /// Which rays.
    pub modes: Vec<Mode>,
    /// Which structures; the first is the base that the others are compared with.
    pub specs: Vec<Spec>,
    /// Width and height of the film, in pixels; one test ray a pixel. The scanner of `lidar` has its own: 64 × 2048.
    pub size: [usize; 2],
    /// How many training rays a view gets, in each mode.
    pub training: usize,
    /// How the training rays are chosen.
    pub protocol: Protocol,
    /// Where they come from, if not from the view that is tested, by the protocol.
    pub rrs: Option<Source>,
    /// Test and training rays use two seeds that are derived from this one.
    pub seed: u64,
    /// How often each structure casts all rays, interleaved with the others.
    pub rounds: usize,
    /// The same in small scenes, whose times are noisier.
    pub small_rounds: usize,
    /// How often small scenes' structures are built, interleaved, to time it. Those of larger scenes are built once.
    pub small_builds: usize,
    /// Scenes of fewer triangles are small.
    pub small_triangles: usize,
    /// Threads that make and count rays; `None` is rayon's current pool. What is timed always runs on one.
    pub threads: Option<usize>,
}

/// One unit of work: a view of a scene in a mode.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Case {
    /// The scene's id.
    pub scene: String,
    /// The view's name.
    pub view: String,
    /// The frame.
    pub frame: u32,
    /// The mode.
    pub mode: Mode,
}

impl Default for Plan {
    /// 512 × 512 test rays, 16,384 training rays, the three default specs.
    fn default() -> Self {
        Self {
            targets: Vec::new(),
            modes: vec![Mode::Primary],
            specs: Self::default_specs(),
            size: [512, 512],
            training: 16_384,
            protocol: Protocol::Unseen,
            rrs: None,
            seed: 1,
            rounds: 3,
            small_rounds: 5,
            small_builds: 3,
            small_triangles: 100_000,
            threads: None,
        }
    }
}

impl Plan {
    /// A quarter of the rays, and the fewest rounds that give an interval: for a first look.
    pub fn quick() -> Self {
        Self { size: [256, 256], training: 4_096, small_rounds: 3, small_builds: 1, ..Self::default() }
    }

    /// `kd+sah`, the paper's heuristic, and ours.
    pub fn default_specs() -> Vec<Spec> {
        let kd = |heuristic| Spec { heuristic, ..Spec::default() };
        let [paper, ours] = [RdhSpec::PAPER, RdhSpec::default()].map(HeuristicSpec::Rdh);
        vec![kd(HeuristicSpec::Sah), kd(paper), kd(ours)]
    }

    /// Rounds for a scene of so many triangles.
    pub fn rounds_for(&self, triangles: usize) -> usize {
        if triangles < self.small_triangles { self.small_rounds } else { self.rounds }
    }

    /// Builds for a scene of so many triangles.
    pub fn builds_for(&self, triangles: usize) -> usize {
        if triangles < self.small_triangles { self.small_builds.max(1) } else { 1 }
    }

    /// The cases, as far as the views are known before scenes are loaded; their number is what progress is measured by.
    pub fn cases(&self) -> Vec<Case> {
        let mut cases = Vec::new();
        for target in &self.targets {
            for &frame in &target.frames {
                for view in target.view_names() {
                    for &mode in &self.modes {
                        cases.push(Case { scene: target.entry.id.clone(), view: view.clone(), frame, mode });
                    }
                }
            }
        }
        cases
    }

    /// Refuses plans that ask for nothing or for nonsense.
    ///
    /// # Errors
    /// [`Error::Plan`], saying what to change.
    pub fn check(&self) -> Result<()> {
        let fail = |why: String| Err(Error::Plan(why));
        refuse_twice("spec", &self.specs)?;
        refuse_twice("mode", &self.modes)?;
        let empty = [
            ("scenes", self.targets.is_empty()),
            ("modes", self.modes.is_empty()),
            ("specs", self.specs.is_empty()),
            ("pixels", self.size.contains(&0)),
            ("rounds", self.rounds == 0 || self.small_rounds == 0),
            ("training rays", self.training == 0 && self.specs.iter().any(Spec::needs_rays)),
        ];
        if let Some((what, _)) = empty.iter().find(|(_, is_empty)| *is_empty) {
            return fail(format!("nothing to do: no {what}"));
        }
        if let (Some(Source::None), Some(spec)) = (&self.rrs, self.specs.iter().find(|s| s.needs_rays())) {
            return fail(format!("spec '{spec}' needs rays, and there are to be none"));
        }
        let pixels = self.size[0].checked_mul(self.size[1]).filter(|&n| n <= Self::MAX_PIXELS);
        if pixels.is_none() || self.training > Self::MAX_PIXELS {
            return fail(format!("at most {} pixels and training rays are possible", Self::MAX_PIXELS));
        }
        match self.targets.iter().find(|t| t.frames.is_empty()) {
            Some(target) => fail(format!("scene '{}': no frames", target.entry.id)),
            None => Ok(()),
        }
    }

    /// More rays than this would not fit into memory together with the trees.
    pub const MAX_PIXELS: usize = 1 << 26;
}

/// An error if something stands twice in a list.
pub(crate) fn refuse_twice<T: PartialEq + Display>(what: &str, items: impl IntoIterator<Item = T>) -> Result<()> {
    let mut seen = Vec::new();
    for item in items {
        if seen.contains(&item) {
            return Err(Error::Plan(format!("{what} '{item}' is given twice")));
        }
        seen.push(item);
    }
    Ok(())
}
