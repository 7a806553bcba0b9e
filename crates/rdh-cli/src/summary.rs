//! Tables of summaries.

use clap::builder::styling::Style;
use rdh::RayClass;
use rdh_study::study::experiment;
use rdh_study::{Document, Over, Summary};

use crate::context::Styles;
use crate::table::{Cell, Table};

/// The summaries of a study: for each experiment and setting, over all pairs, and over all kinds of scene alike.
pub(crate) fn study_text(document: &Document, styles: &Styles) -> String {
    let mut text = String::new();
    let mut last = None;
    for part in document.summary.chunk_by(|a, b| place(a) == place(b)) {
        let name = part[0].experiment.as_deref().unwrap_or_default();
        if last != Some(name) {
            let question = experiment::find(name).map_or("", |e| e.question());
            text += &format!("\n{}{name}{}: {question}\n", styles.head.render(), styles.head.render_reset());
            last = Some(name);
        }
        for (over, note) in [(Over::Pairs, ""), (Over::Kinds, "; kinds of scene weigh alike")] {
            let of: Vec<&Summary> = part.iter().filter(|s| s.over == over).collect();
            if !of.is_empty() {
                text += &format!("\n{}{note}\n", part[0].setting.as_deref().unwrap_or_default());
                text += &summary_text(&of, styles);
            }
        }
    }
    text
}

fn place(s: &Summary) -> (&Option<String>, &Option<String>, Option<u64>) {
    (&s.experiment, &s.setting, s.x.map(f64::to_bits))
}

/// Summaries against one base, a line each.
pub(crate) fn summary_text(summary: &[&Summary], styles: &Styles) -> String {
    let Some(first) = summary.first() else { return String::new() };
    let base = first.base.to_string();
    let against = format!("spec / {base}");
    let mut table = Table::new(&[
        &against,
        "rays of",
        ">pairs",
        ">steps",
        ">tests",
        ">time",
        "95 % interval",
        ">build",
        ">+rays",
        ">bytes",
        ">faster",
        ">slower",
    ]);
    for s in summary {
        let [low, high] = s.time_ratio_ci95;
        let class = s.class.map_or("all", RayClass::name);
        let class = if s.mode.name() == class { class.to_owned() } else { format!("{} {class}", s.mode) };
        let mut row: Vec<Cell> = vec![s.spec.to_string().into(), class.into(), s.n.to_string().into()];
        row.extend([s.steps_ratio, s.tests_ratio, s.time_ratio].map(|ratio| ratio_cell(ratio, styles)));
        row.push(format!("{low:.3} to {high:.3}").into());
        row.extend([s.build_ratio, s.build_and_rrs_ratio, s.bytes_ratio].map(|r| Cell::from(format!("{r:.2}"))));
        row.extend([s.faster_cases, s.slower_cases].map(|n| Cell::from(n.to_string())));
        table.push(row);
    }
    table.text(styles.head)
}

/// A ratio to the base, green if it is better and red if it is worse, by more than 1 %.
pub(crate) fn ratio_cell(ratio: f64, styles: &Styles) -> Cell {
    let style = match ratio {
        r if r < 0.99 => styles.better,
        r if r > 1.01 => styles.worse,
        _ => Style::new(),
    };
    Cell::styled(format!("{ratio:.3}"), style)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn better_is_green_worse_is_red_and_equal_is_plain() {
        let styles = Styles { better: Style::new().bold(), worse: Style::new().italic(), ..Styles::default() };
        let mut table = Table::new(&["a", "b", "c"]);
        table.push([0.5, 1.5, 1.0].map(|r| ratio_cell(r, &styles)).into());
        let text = table.text(Style::new());
        assert!(text.contains(&format!("{}0.500", Style::new().bold().render())), "{text:?}");
        assert!(text.contains(&format!("{}1.500", Style::new().italic().render())), "{text:?}");
        assert!(text.contains("  1.000\n"), "{text:?}");
    }
}
