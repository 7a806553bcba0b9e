//! Specs: what is to be built, as plain data with one text form everywhere, `STRUCTURE+HEURISTIC`.
//!
//! `kd+sah`, `kd(leaf=1,split=exact)+rdh(prior=32)`, `kd+rdh(paper)`: defaults are omitted, either part may come
//! first, a missing part is its default. An unknown name or parameter is an error that lists the known ones. `auto` stands alone:
//! what suits the rays, chosen by [`tune`](crate::tune()). `kd(eye=1,2,3)+sah` is for the rays from a point.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::bvh::{self, BvhSpec, Effort, Splitter, Triangles, When, Width};
use crate::error::{Error, Result};
use crate::eye::{EyeForm, EyeSpec};
use crate::geom::Vec3;
use crate::heuristic::{Blend, By, HeuristicSpec, RayExtent, RdhSpec, Stages};
use crate::kd::{KdSpec, LeafWidth, Prune, SplitSearch, Stop};

/// What is to be built.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spec {
    /// The structure.
    pub structure: StructureSpec,
    /// What decides its splits.
    pub heuristic: HeuristicSpec,
}

/// Which structure, with its parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StructureSpec {
    /// A kd-tree.
    Kd(KdSpec),
    /// A bounding volume hierarchy.
    Bvh(BvhSpec),
    /// Kd-trees in the perspective space of a point, for the rays through it, and a hierarchy for all others.
    Eye(EyeSpec),
    /// Whichever suits the rays. Only [`Spec::AUTO`] has it; a finished structure is never of this kind.
    Auto,
}

impl Default for StructureSpec {
    fn default() -> Self {
        Self::Kd(KdSpec::default())
    }
}

impl Spec {
    /// `auto`: structure and heuristic are chosen by the rays.
    pub const AUTO: Self = Self { structure: StructureSpec::Auto, heuristic: HeuristicSpec::Sah };

    /// Whether the heuristic, the choice, or an eye whose place is left open needs a profile.
    pub fn needs_rays(&self) -> bool {
        let open = match self.structure {
            StructureSpec::Auto => true,
            StructureSpec::Eye(eye) => eye.place.is_none(),
            _ => false,
        };
        open || matches!(self.heuristic, HeuristicSpec::Rdh(_))
    }

    /// Refuses parts that don't go together.
    pub(crate) fn check(&self) -> Result<()> {
        let stages = match self.heuristic {
            HeuristicSpec::Rdh(rdh) => rdh.stages,
            _ => Stages::default(),
        };
        let reason = match self.structure {
            StructureSpec::Bvh(BvhSpec { split: bvh::SplitSearch::Sweep, splitter: Splitter::Objects, .. })
                if self.needs_rays() && stages.splits == By::Rays =>
            {
                "split=sweep compares areas: rdh counts rays between bins, unless splits=areas".to_owned()
            }
            StructureSpec::Bvh(bvh) if bvh.when == When::OnDemand && !bvh.can_be_lazy() => {
                "lazy is for bvh8, alone or with quick or high".to_owned()
            }
            StructureSpec::Kd(_) if stages != Stages::default() => {
                format!("a kd-tree has no stages {}", Stages::NAMES.join(", "))
            }
            _ => return Ok(()),
        };
        Err(Error::Spec { spec: self.to_string(), reason })
    }

    /// Parses a list of specs. Commas inside brackets don't separate.
    ///
    /// # Errors
    /// [`Error::Spec`] for the first part that can't be understood.
    pub fn list(text: &str) -> Result<Vec<Self>> {
        split_outside_brackets(text, ',').into_iter().map(str::parse).collect()
    }
}

impl FromStr for Spec {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let fail = |reason: String| Error::Spec { spec: text.to_owned(), reason };
        if text.trim() == "auto" {
            return Ok(Self::AUTO);
        }
        let (mut structure, mut heuristic) = (None, None);
        for part in split_outside_brackets(text, '+') {
            let part = Part::parse(part).map_err(fail)?;
            match part.name {
                "kd" if is_eye(&part) => {
                    set_once(&mut structure, StructureSpec::Eye(parse_eye(&part).map_err(fail)?), "structure")
                }
                "kd" => set_once(&mut structure, StructureSpec::Kd(parse_kd(&part).map_err(fail)?), "structure"),
                "bvh2" | "bvh4" | "bvh8" | "sbvh2" | "sbvh4" | "sbvh8" => {
                    set_once(&mut structure, StructureSpec::Bvh(parse_bvh(&part).map_err(fail)?), "structure")
                }
                "sah" => set_once(&mut heuristic, parse_sah(&part).map_err(fail)?, "heuristic"),
                "rdh" => set_once(&mut heuristic, HeuristicSpec::Rdh(parse_rdh(&part).map_err(fail)?), "heuristic"),
                "auto" => Err("auto chooses structure and heuristic: it stands alone, without parameters".to_owned()),
                other => Err(format!("unknown name '{other}'; structures: kd, bvh2, bvh4, bvh8, sbvh2, sbvh4, sbvh8; heuristics: sah, rdh; or auto")),
            }
            .map_err(fail)?;
        }
        let spec = Self { structure: structure.unwrap_or_default(), heuristic: heuristic.unwrap_or_default() };
        spec.check()?;
        Ok(spec)
    }
}

impl fmt::Display for Spec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.structure {
            StructureSpec::Auto => return f.write_str("auto"),
            StructureSpec::Kd(kd) => write!(f, "kd{}+", brackets(&kd_parameters(kd)))?,
            StructureSpec::Bvh(bvh) => write!(f, "{}{}+", bvh_name(bvh), brackets(&bvh_parameters(bvh)))?,
            StructureSpec::Eye(eye) => write!(f, "kd({})+", eye_parameter(eye))?,
        }
        match &self.heuristic {
            HeuristicSpec::Sah => write!(f, "sah"),
            HeuristicSpec::Rdh(rdh) => write!(f, "rdh{}", brackets(&rdh_parameters(rdh))),
        }
    }
}

impl Serialize for Spec {
    fn serialize<S: Serializer>(&self, s: S) -> std::result::Result<S::Ok, S::Error> {
        s.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Spec {
    fn deserialize<D: Deserializer<'de>>(d: D) -> std::result::Result<Self, D::Error> {
        String::deserialize(d)?.parse().map_err(serde::de::Error::custom)
    }
}

fn parse_kd(part: &Part<'_>) -> Result<KdSpec, String> {
    let mut kd = KdSpec::default();
    let given = |key: &str| part.parameters.iter().any(|(k, _)| *k == key);
    for &(key, value) in &part.parameters {
        match key {
            "leaf" => kd.leaf = choice(key, value, &[("1", LeafWidth::One), ("8", LeafWidth::Eight)])?,
            "split" => {
                kd.split = choice(key, value, &[("exact", SplitSearch::Exact), ("binned", SplitSearch::Binned)])?;
            }
            "prune" => {
                let known = [("none", Prune::None), ("area", Prune::Area), ("visits", Prune::Visits)];
                kd.prune = choice(key, value, &known)?;
            }
            "stop" => {
                kd.stop = choice(key, value, &[("cost", Stop::Cost), ("auto", Stop::Auto), ("paper", Stop::Paper)])?
            }
            "idle" => kd.idle = number(key, value, 0.0, 1e9)?,
            "compact" if value.is_empty() && !given("idle") => kd.idle = KdSpec::COMPACT.idle,
            "compact" => return Err("compact is a value of idle: give one of them".to_owned()),
            _ => {
                return Err(unknown(
                    "kd",
                    key,
                    "leaf=1|8, split=exact|binned, prune=none|area|visits, stop=cost|auto|paper, idle=COST, compact; or alone \
                     eye, eye=X,Y,Z, light or light=X,Y,Z",
                ));
            }
        }
    }
    Ok(kd)
}

fn kd_parameters(kd: &KdSpec) -> Vec<String> {
    let default = KdSpec::default();
    let mut out = Vec::new();
    let mut push = |differs: bool, text: &str| differs.then(|| out.push(text.to_owned()));
    push(kd.leaf != default.leaf, if kd.leaf == LeafWidth::One { "leaf=1" } else { "leaf=8" });
    push(kd.split != default.split, if kd.split == SplitSearch::Exact { "split=exact" } else { "split=binned" });
    match kd.prune {
        Prune::ByHeuristic => None,
        Prune::None => push(true, "prune=none"),
        Prune::Area => push(true, "prune=area"),
        Prune::Visits => push(true, "prune=visits"),
    };
    match kd.stop {
        Stop::Auto => None,
        Stop::Cost => push(true, "stop=cost"),
        Stop::Paper => push(true, "stop=paper"),
    };
    push(kd.idle != default.idle, &format!("idle={}", kd.idle));
    out
}

fn parse_bvh(part: &Part<'_>) -> Result<BvhSpec, String> {
    let width = match part.name {
        "bvh2" | "sbvh2" => Width::Two,
        "bvh4" | "sbvh4" => Width::Four,
        _ => Width::Eight,
    };
    let splitter = if part.name.starts_with('s') { Splitter::Spatial } else { Splitter::Objects };
    let mut bvh = BvhSpec { width, splitter, ..BvhSpec::default() };
    for &(key, value) in &part.parameters {
        match (key, value) {
            ("quick" | "high", "") if bvh.effort != Effort::Default => return Err("quick or high: give one".to_owned()),
            ("quick", "") => bvh.effort = Effort::Quick,
            ("high", "") => bvh.effort = Effort::High,
            ("split", _) => {
                bvh.split =
                    choice(key, value, &[("binned", bvh::SplitSearch::Binned), ("sweep", bvh::SplitSearch::Sweep)])?;
            }
            ("from", _) if splitter == Splitter::Spatial => {
                return Err(format!(
                    "from belongs to {}: spatial splits are another way to cut triangles",
                    &part.name[1..]
                ));
            }
            ("from", _) => bvh.splitter = choice(key, value, &[("kd", Splitter::KdTree)])?,
            ("compact", "") if width == Width::Eight => bvh.triangles = Triangles::Shared,
            ("compact", "") => return Err(format!("compact is for bvh8 and sbvh8, not for {}", part.name)),
            ("lazy", "") => bvh.when = When::OnDemand,
            _ => return Err(unknown(part.name, key, "quick, high, split=binned|sweep, from=kd, compact, lazy")),
        }
    }
    Ok(bvh)
}

/// What the parameters of trees around a point are called.
const EYE: &str = "eye";
const LIGHT: &str = "light";

fn is_eye(part: &Part<'_>) -> bool {
    part.parameters.iter().any(|(key, _)| [EYE, LIGHT].contains(key))
}

fn parse_eye(part: &Part<'_>) -> Result<EyeSpec, String> {
    let &[(key, value)] = &part.parameters[..] else {
        return Err(format!("{EYE} and {LIGHT} stand alone: trees around a point have no other parameters"));
    };
    let form = if key == LIGHT { EyeForm::Towards } else { EyeForm::From };
    let place = if value.is_empty() { None } else { Some(place(key, value)?) };
    Ok(EyeSpec { place, form })
}

fn place(key: &str, value: &str) -> Result<Vec3, String> {
    let numbers = value.split(',').map(|x| x.trim().parse().ok().filter(|x: &f32| x.is_finite()));
    let place = numbers.collect::<Option<Vec<f32>>>().and_then(|numbers| numbers.try_into().ok());
    place.ok_or_else(|| format!("{key}={value}: three finite numbers are needed, {key}=X,Y,Z"))
}

fn eye_parameter(eye: &EyeSpec) -> String {
    let name = if eye.form == EyeForm::Towards { LIGHT } else { EYE };
    eye.place.map_or_else(|| name.to_owned(), |[x, y, z]| format!("{name}={x},{y},{z}"))
}

fn bvh_name(bvh: &BvhSpec) -> &'static str {
    match (bvh.splitter, bvh.width) {
        (Splitter::Spatial, Width::Two) => "sbvh2",
        (Splitter::Spatial, Width::Four) => "sbvh4",
        (Splitter::Spatial, Width::Eight) => "sbvh8",
        (_, Width::Two) => "bvh2",
        (_, Width::Four) => "bvh4",
        (_, Width::Eight) => "bvh8",
    }
}

fn bvh_parameters(bvh: &BvhSpec) -> Vec<String> {
    let effort = match bvh.effort {
        Effort::Quick => Some("quick"),
        Effort::Default => None,
        Effort::High => Some("high"),
    };
    let split = (bvh.split == bvh::SplitSearch::Sweep).then_some("split=sweep");
    let from = (bvh.splitter == Splitter::KdTree).then_some("from=kd");
    let compact = (bvh.triangles == Triangles::Shared).then_some("compact");
    let lazy = (bvh.when == When::OnDemand).then_some("lazy");
    effort.into_iter().chain(split).chain(from).chain(compact).chain(lazy).map(str::to_owned).collect()
}

fn parse_sah(part: &Part<'_>) -> Result<HeuristicSpec, String> {
    match part.parameters.first() {
        None => Ok(HeuristicSpec::Sah),
        Some((key, _)) => Err(unknown("sah", key, "none")),
    }
}

fn parse_rdh(part: &Part<'_>) -> Result<RdhSpec, String> {
    let given = |key: &str| part.parameters.iter().any(|(k, _)| *k == key);
    if given("prior") && (given("weight") || given("blend")) {
        return Err("prior belongs to another blend than weight and blend=paper: give one of them".to_owned());
    }
    // What the others refine comes first, wherever it stands.
    let mut rdh = if given("paper") { RdhSpec::PAPER } else { RdhSpec::default() };
    for &(key, value) in &part.parameters {
        match (key, value) {
            ("paper", "") => {}
            ("blend", "paper") if given("weight") => {}
            ("blend", "paper") => rdh.blend = RdhSpec::PAPER.blend,
            ("weight", _) => rdh.blend = Blend::Paper { weight: number(key, value, 0.0, 1.0)? },
            ("prior", _) => rdh.blend = Blend::Confidence { prior: number(key, value, 0.0, 1e9)? },
            ("rays", _) => {
                rdh.rays = choice(key, value, &[("clipped", RayExtent::Clipped), ("whole", RayExtent::Whole)])?;
            }
            (stage, _) if Stages::NAMES.contains(&stage) => {
                if let Some(by) = rdh.stages.get_mut(stage) {
                    *by = choice(key, value, &[("rays", By::Rays), ("areas", By::Areas)])?;
                }
            }
            ("cap", _) => rdh.cap = Some(value.parse().map_err(|_| format!("cap={value}: a whole number is needed"))?),
            _ => {
                let known = "paper, prior=NUMBER, rays=clipped|whole, cap=COUNT, blend=paper, weight=0..1, and for hierarchies \
                             splits, moves, cuts and order=rays|areas";
                return Err(unknown("rdh", key, known));
            }
        }
    }
    Ok(rdh)
}

fn rdh_parameters(rdh: &RdhSpec) -> Vec<String> {
    let mut out = Vec::new();
    let base = match rdh.blend {
        Blend::Paper { weight } => {
            out.push("paper".to_owned());
            if rdh.blend != RdhSpec::PAPER.blend {
                out.push(format!("weight={weight}"));
            }
            RdhSpec::PAPER
        }
        Blend::Confidence { prior } => {
            if rdh.blend != RdhSpec::default().blend {
                out.push(format!("prior={prior}"));
            }
            RdhSpec::default()
        }
    };
    if rdh.rays != base.rays {
        out.push(format!("rays={}", if rdh.rays == RayExtent::Whole { "whole" } else { "clipped" }));
    }
    if let Some(cap) = rdh.cap.filter(|_| rdh.cap != base.cap) {
        out.push(format!("cap={cap}"));
    }
    let mut stages = rdh.stages;
    let by_areas = Stages::NAMES.iter().filter(|name| stages.get_mut(name).is_some_and(|by| *by == By::Areas));
    out.extend(by_areas.map(|name| format!("{name}=areas")));
    out
}

/// `name(key=value,flag)` taken apart.
struct Part<'a> {
    name: &'a str,
    parameters: Vec<(&'a str, &'a str)>,
}

impl<'a> Part<'a> {
    fn parse(text: &'a str) -> Result<Self, String> {
        let text = text.trim();
        let Some((name, rest)) = text.split_once('(') else {
            return Ok(Self { name: text, parameters: Vec::new() });
        };
        let inner = rest.strip_suffix(')').ok_or_else(|| format!("'{text}' lacks its closing bracket"))?;
        let pair = |p: &'a str| p.split_once('=').map_or((p.trim(), ""), |(k, v)| (k.trim(), v.trim()));
        let parameters: Vec<_> = split_before_names(inner).filter(|p| !p.trim().is_empty()).map(pair).collect();
        let twice = parameters.iter().enumerate().find(|(i, (key, _))| parameters[..*i].iter().any(|(k, _)| k == key));
        if let Some((_, (key, _))) = twice {
            return Err(format!("'{key}' is given twice"));
        }
        Ok(Self { name: name.trim(), parameters })
    }
}

fn set_once<T>(slot: &mut Option<T>, value: T, what: &str) -> Result<(), String> {
    match slot.replace(value) {
        None => Ok(()),
        Some(_) => Err(format!("there is more than one {what}")),
    }
}

fn choice<T: Copy>(key: &str, value: &str, known: &[(&str, T)]) -> Result<T, String> {
    known.iter().find(|(name, _)| *name == value).map(|&(_, v)| v).ok_or_else(|| {
        let names: Vec<_> = known.iter().map(|(name, _)| *name).collect();
        format!("{key}={value}: known are {}", names.join(", "))
    })
}

fn number(key: &str, value: &str, min: f32, max: f32) -> Result<f32, String> {
    let parsed = value.parse().ok().filter(|x| (min..=max).contains(x));
    parsed.ok_or_else(|| format!("{key}={value}: a number from {min} to {max} is needed"))
}

fn unknown(name: &str, key: &str, known: &str) -> String {
    format!("{name} has no parameter '{key}'; known: {known}")
}

fn brackets(parameters: &[String]) -> String {
    if parameters.is_empty() { String::new() } else { format!("({})", parameters.join(",")) }
}

/// Splits at commas, but not before a number, which belongs to the value before it: `a,b=1,2,3`.
fn split_before_names(text: &str) -> impl Iterator<Item = &str> {
    let mut rest = Some(text);
    std::iter::from_fn(move || {
        let text = rest?;
        let is_number = |part: &str| part.trim().starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
        let mut commas = text.match_indices(',').map(|(i, _)| i);
        let comma = commas.find(|&i| !is_number(text[i + 1..].split(',').next().unwrap_or_default()));
        rest = comma.map(|i| &text[i + 1..]);
        Some(comma.map_or(text, |i| &text[..i]))
    })
}

fn split_outside_brackets(text: &str, separator: char) -> Vec<&str> {
    let (mut depth, mut start, mut parts) = (0i32, 0, Vec::new());
    for (i, c) in text.char_indices() {
        match c {
            '(' => depth += 1,
            ')' => depth -= 1,
            c if c == separator && depth == 0 => {
                parts.push(&text[start..i]);
                start = i + c.len_utf8();
            }
            _ => {}
        }
    }
    parts.push(&text[start..]);
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn specs_round_trip_in_their_shortest_form() {
        for (text, canonical) in [
            ("kd+sah", "kd+sah"),
            ("sah+kd", "kd+sah"),
            ("kd", "kd+sah"),
            ("rdh", "kd+rdh"),
            ("kd(leaf=8,split=binned)+rdh(prior=16)", "kd+rdh"),
            ("kd+rdh(paper)", "kd+rdh(paper)"),
            ("kd(idle=1e-4)+rdh", "kd(idle=0.0001)+rdh"),
            ("kd(idle=0,stop=cost)", "kd(stop=cost)+sah"),
            ("kd(compact)+rdh", "kd(idle=0.001)+rdh"),
            ("sbvh8", "sbvh8+sah"),
            ("bvh8+rdh(order=areas,splits=areas,cuts=rays)", "bvh8+rdh(splits=areas,order=areas)"),
            ("bvh8(split=sweep,high)", "bvh8(high,split=sweep)+sah"),
            ("bvh8(split=binned)", "bvh8+sah"),
            (" auto ", "auto"),
            ("bvh4(quick)+sah", "bvh4(quick)+sah"),
            ("bvh8(from=kd,high)+rdh", "bvh8(high,from=kd)+rdh"),
            ("sbvh8(compact,quick)", "sbvh8(quick,compact)+sah"),
            ("bvh8(lazy,quick)", "bvh8(quick,lazy)+sah"),
            ("bvh8(lazy)+rdh", "bvh8(lazy)+rdh"),
            ("kd(eye)", "kd(eye)+sah"),
            ("kd(light)+rdh", "kd(light)+rdh"),
            ("kd(eye=1.50, -2,3e2)+rdh", "kd(eye=1.5,-2,300)+rdh"),
            ("sah+kd(light=-0,.5,1e-7)", "kd(light=-0,0.5,0.0000001)+sah"),
            ("kd+rdh(rays=whole,blend=paper,cap=0)", "kd+rdh(paper)"),
            ("kd+rdh(paper,weight=0)", "kd+rdh(paper,weight=0)"),
            ("kd+rdh(cap=100,paper)", "kd+rdh(paper,cap=100)"),
            ("kd+rdh(weight=0.5,blend=paper,rays=whole,cap=0)", "kd+rdh(paper,weight=0.5)"),
            ("kd(stop=paper, prune=none)+rdh(prior=2.5,cap=100)", "kd(prune=none,stop=paper)+rdh(prior=2.5,cap=100)"),
        ] {
            let spec: Spec = text.parse().unwrap();
            assert_eq!(spec.to_string(), canonical);
            assert_eq!(canonical.parse::<Spec>().unwrap(), spec);
        }
    }

    #[test]
    fn nothing_unknown_is_ignored() {
        for text in [
            "",
            "bvh9+sah",
            "bvh8(from=bvh)",
            "bvh4(compact)",
            "bvh4(lazy)",
            "sbvh8(lazy)",
            "bvh8(lazy,compact)",
            "bvh8(lazy,from=kd)",
            "bvh8(lazy,split=sweep)",
            "bvh8(lazy=yes)",
            "kd(compact=2)",
            "kd(eye=1,2)",
            "kd(eye=1,2,3,4)",
            "kd(eye=1,2,x)",
            "kd(eye=1,2,inf)",
            "kd(eye=1,2,3,leaf=8)",
            "kd(eye,light=1,2,3)",
            "bvh8(light)",
            "bvh8(eye)",
            "kd(leaf=8,1)",
            "kd(compact,idle=0.1)",
            "sbvh8(from=kd)",
            "bvh8(quick,high)",
            "bvh8(split=exact)",
            "bvh8(split=sweep)+rdh",
            "kd(leaf=3)",
            "kd(leaves=8)",
            "kd(idle=-1)",
            "kd(idle=NaN)",
            "sah(x=1)",
            "rdh(prior=-1)",
            "kd+kd",
            "kd(leaf=8",
            "kd+sah+rdh",
            "kd+rdh(order=areas)",
            "bvh8+rdh(order=area)",
            "auto+sah",
            "auto(x=1)",
        ] {
            assert!(text.parse::<Spec>().is_err(), "{text}");
        }
        let message = "kd(leaves=8)".parse::<Spec>().unwrap_err().to_string();
        assert!(message.contains("leaf=1|8"), "{message}");
    }

    #[test]
    fn commas_in_brackets_do_not_separate_specs() {
        let list = Spec::list("kd+sah,kd(leaf=1,split=exact)+rdh(paper),kd(eye=1,2,3),kd+rdh").unwrap();
        assert_eq!(list.len(), 4);
    }
}
