//! Where the rays come from that a tree is built for.

use std::fmt;
use std::str::FromStr;

use rdh::{BuildOptions, Profile, Spec, Training};
use rdh_scene::View;

use super::lab::Lab;
use crate::clock::{time_process, time_thread};
use crate::error::{Error, Result};
use crate::integrate::{Mode, Shoot};
use crate::plan::{Plan, Protocol};
use crate::run::Lesson;

/// Where the representative rays come from, as in `--rrs`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Source {
    /// There are none.
    None,
    /// One in so many of this frame's own pixels. They are paid for: a first tree is built in a hurry, and the pixels
    /// are cast through it before the real tree is built.
    Frame(u32),
    /// The frame so many frames ago, along a camera path or of an animation. They are there already.
    Previous(u32),
    /// Another view of the same scene.
    View(String),
    /// All views of the scene alike.
    All,
}

impl Source {
    const KNOWN: &str = "none, frame:1/N, previous:K, view:NAME, all";
    /// The tree that is built in a hurry.
    const HURRY: &str = "bvh8(quick)+sah";

    /// The rays for a view in a mode; a view of a camera path is named `path@frame`.
    ///
    /// # Errors
    /// A view or a frame that there isn't, in words.
    pub fn lesson(&self, lab: &Lab<'_>, view: &View, mode: Mode) -> Result<Lesson, String> {
        let count = lab.plan.training;
        match self {
            Self::None => Ok(Lesson::none()),
            Self::Frame(part) => this_frame(lab, view, mode, *part),
            Self::Previous(frames) => previous(lab, view, mode, *frames),
            Self::View(name) => Ok(lab.lesson(&lab.view(name)?, mode, Protocol::Unseen, count)),
            Self::All => Ok(all_views(lab, mode, count)),
        }
    }
}

/// One in `part` pixels, through a tree that is built in a hurry; both are paid for.
fn this_frame(lab: &Lab<'_>, view: &View, mode: Mode, part: u32) -> Result<Lesson, String> {
    let [columns, rows] = mode.film(lab.plan.size);
    let count = (columns * rows / part.max(1) as usize).max(1);
    let plan = Plan { protocol: Protocol::Paper, training: count, ..lab.plan.clone() };
    let spec: Spec = Source::HURRY.parse().map_err(|e: rdh::Error| e.to_string())?;
    let options = BuildOptions { threads: Some(1), ..BuildOptions::default() };
    let (first, build_secs) = time_process(|| rdh::build(lab.mesh(), &spec, &Training::none(), &options));
    let first = first.map_err(|e| e.to_string())?;
    let (training, secs) = time_thread(|| Shoot::new(&lab.stage, mode, view, &plan).training(&first, 0));
    Ok(Lesson { training, secs: build_secs + secs, view: view.name.clone(), frame: lab.frame })
}

/// The rays of an earlier frame. They were cast for that frame's picture, so they cost nothing more.
fn previous(lab: &Lab<'_>, view: &View, mode: Mode, frames: u32) -> Result<Lesson, String> {
    let count = lab.plan.training;
    let lesson = match path_view(lab, &view.name, frames)? {
        Some(earlier) => lab.lesson(&earlier, mode, Protocol::Unseen, count),
        None => {
            let too_few = || format!("frame {} has no frame {frames} before it", lab.frame);
            let earlier = lab.at_frame(lab.frame.checked_sub(frames).ok_or_else(too_few)?)?;
            earlier.lesson(view, mode, Protocol::Unseen, count)
        }
    };
    Ok(Lesson { secs: 0.0, ..lesson })
}

/// A view along a camera path, some frames before the named one: `walk@60`. Nothing for views that are on no path.
///
/// # Errors
/// A frame that isn't a number or lies before the path's first one.
pub(crate) fn path_view(lab: &Lab<'_>, name: &str, before: u32) -> Result<Option<View>, String> {
    let Some((path, frame)) = name.split_once('@') else { return Ok(None) };
    let paths = lab.entry.paths().map_err(|e| e.to_string())?;
    let path = paths.iter().find(|p| p.name == path).ok_or_else(|| format!("there is no path '{path}'"))?;
    let frame: u32 = frame.parse().map_err(|_| format!("'{name}': the frame isn't a number"))?;
    let frame = frame.checked_sub(before).ok_or_else(|| format!("'{name}' has no frame {before} before it"))?;
    Ok(path.at(frame))
}

/// As many rays as one view would give, from all views alike.
fn all_views(lab: &Lab<'_>, mode: Mode, count: usize) -> Lesson {
    let views = lab.views();
    let each = count.div_ceil(views.len().max(1));
    let lessons: Vec<Lesson> = views.iter().map(|v| lab.lesson(v, mode, Protocol::Unseen, each)).collect();
    let samples = lessons.iter().flat_map(|l| l.training.samples().to_vec()).collect();
    // In the order of their hashes, so that every prefix is a fair mixture.
    let training = Training::from_samples(Profile::from_samples(samples, lab.plan.seed).samples().to_vec());
    let secs = lessons.iter().map(|l| l.secs).sum();
    Lesson { training, secs, view: "all".to_owned(), frame: lab.frame }
}

impl FromStr for Source {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let unknown = || Error::UnknownName { what: "source of rays", name: text.to_owned(), known: Self::KNOWN };
        let number = |text: &str| text.parse::<u32>().map_err(|_| unknown());
        match text.split_once(':') {
            None if text == "none" => Ok(Self::None),
            None if text == "all" => Ok(Self::All),
            Some(("frame", part)) => match number(part.strip_prefix("1/").ok_or_else(unknown)?)? {
                0 => Err(unknown()),
                part => Ok(Self::Frame(part)),
            },
            Some(("previous", frames)) => Ok(Self::Previous(number(frames)?)),
            Some(("view", name)) if !name.is_empty() => Ok(Self::View(name.to_owned())),
            _ => Err(unknown()),
        }
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.write_str("none"),
            Self::Frame(part) => write!(f, "frame:1/{part}"),
            Self::Previous(frames) => write!(f, "previous:{frames}"),
            Self::View(name) => write!(f, "view:{name}"),
            Self::All => f.write_str("all"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_round_trip_and_nonsense_is_refused() {
        for text in ["none", "frame:1/64", "previous:8", "view:table", "all"] {
            assert_eq!(text.parse::<Source>().unwrap().to_string(), text);
        }
        for text in ["", "frame", "frame:64", "frame:1/0", "previous:", "previous:-1", "view:", "everything"] {
            assert!(text.parse::<Source>().is_err(), "{text}");
        }
    }
}
