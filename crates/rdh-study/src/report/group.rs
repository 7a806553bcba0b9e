//! Pairs that belong together, and their order.

use maud::{Markup, html};
use rdh::RayClass;
use rdh_scene::Kind;

use super::pairs::Pair;
use super::words;
use crate::integrate::Mode;

/// Pairs that belong together in one line of a table or plot.
#[derive(Debug, Clone)]
pub(super) struct Group<'p, 'r> {
    /// What they have in common, in the order of the keys.
    pub labels: Vec<String>,
    pub pairs: Vec<&'p Pair<'r>>,
}

/// What pairs are grouped by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Key {
    Mode,
    Class,
    Kind,
    Setting,
    Spec,
    Base,
}

/// Groups pairs: by mode and class in their order; settings by family in order of appearance, in it by the axis.
pub(super) fn group<'p, 'r>(pairs: &[&'p Pair<'r>], keys: &[Key]) -> Vec<Group<'p, 'r>> {
    let mut groups: Vec<Group<'p, 'r>> = Vec::new();
    for &pair in pairs {
        let labels: Vec<String> = keys.iter().map(|k| k.label(pair)).collect();
        match groups.iter_mut().find(|g| g.labels == labels) {
            Some(group) => group.pairs.push(pair),
            None => groups.push(Group { labels, pairs: vec![pair] }),
        }
    }
    let mut families: Vec<String> = Vec::new();
    for pair in pairs {
        let name = family(pair);
        if !families.contains(&name) {
            families.push(name);
        }
    }
    let rank = |g: &Group<'_, '_>| rank(g, keys, &families);
    groups.sort_by(|a, b| rank(a).partial_cmp(&rank(b)).unwrap_or(std::cmp::Ordering::Equal));
    groups
}

impl Key {
    /// The head of its column.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Mode => "rays",
            Self::Class => "class",
            Self::Kind => "kind of scene",
            Self::Setting => "setting",
            Self::Spec => "spec",
            Self::Base => "base",
        }
    }

    fn label(self, pair: &Pair<'_>) -> String {
        match self {
            Self::Mode => pair.job.mode.name().to_owned(),
            Self::Class => words::class(pair.class).to_owned(),
            Self::Kind => words::kind(pair.kind).to_owned(),
            Self::Setting => pair.setting.to_owned(),
            Self::Spec => pair.spec.to_string(),
            Self::Base => pair.base.to_string(),
        }
    }

    /// A label as it is shown.
    pub(super) fn cell(self, label: &str) -> Markup {
        match self {
            Self::Spec | Self::Base => html! { code { (label) } },
            _ => html! { (label) },
        }
    }
}

/// The setting, without its number if it has a place on the axis: settings that differ in that alone are a family.
pub(super) fn family(pair: &Pair<'_>) -> String {
    if pair.x.is_none() {
        return pair.setting.to_owned();
    }
    let is_word = |word: &&str| !word.is_empty() && word.parse::<f64>().is_err();
    pair.setting.split([' ', ':', '=']).filter(is_word).collect::<Vec<_>>().join(" ")
}

type Rank = (Option<Mode>, Option<(bool, Option<RayClass>)>, Option<Kind>, Option<(usize, Option<f64>)>);

/// Only what is grouped by decides the order; a stable sort leaves the rest as it came.
fn rank(group: &Group<'_, '_>, keys: &[Key], families: &[String]) -> Rank {
    let first = group.pairs[0];
    let has = |key: Key| keys.contains(&key);
    let place = || (families.iter().position(|f| *f == family(first)).unwrap_or_default(), first.x);
    (
        has(Key::Mode).then_some(first.job.mode),
        has(Key::Class).then_some((first.class.is_none(), first.class)),
        has(Key::Kind).then_some(first.kind),
        has(Key::Setting).then(place),
    )
}
