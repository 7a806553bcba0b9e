//! Views as pictures: what each pixel costs under both heuristics, and the cells behind it.

use data_encoding::BASE64;
use maud::{Markup, html};

use super::super::about::{Panel, Picture, Scale};
use super::super::svg::short;
use super::super::view::Study;
use super::{Chapter, Section};

pub(super) const CHAPTER: Chapter = Chapter {
    id: "pictures",
    title: "What it looks like",
    question: "Where in a picture are steps and tests saved, and what do the trees look like there?",
    write,
};

fn write(study: &Study<'_>) -> Option<Section> {
    let pictures = &study.about.pictures;
    if pictures.is_empty() {
        return None;
    }
    let body = html! {
        p {
            "Each pixel is coloured by what its primary ray costs; one scale for both structures. In the differences blue is less than under "
            "areas, red is more. In the slices, cells are filled by the number of their triangles, surfaces are black, sampled rays orange."
        }
        @for picture in pictures { (row(picture)) }
    };
    Some(Section { findings: Vec::new(), body })
}

fn row(picture: &Picture) -> Markup {
    html! {
            figure.pictures {
                h3 { code { (picture.place) } }
                p.note { (picture.why) }
    @for row in &picture.rows { div.panels { @for panel in row { (draw(panel)) } } }
            }
        }
}

fn draw(panel: &Panel) -> Markup {
    let source = format!("data:image/png;base64,{}", BASE64.encode(&panel.png));
    html! {
        div.panel {
            img src=(source) width=(panel.size[0]) height=(panel.size[1]) alt=(panel.says);
            @if let Some(scale) = &panel.scale { (bar(scale)) }
            p { strong { (panel.title) } " " span.aside-text { (panel.note) } }
        }
    }
}

fn bar(scale: &Scale) -> Markup {
    let colours: Vec<String> = scale.colours.iter().map(|[r, g, b]| format!("rgb({r} {g} {b})")).collect();
    html! {
        div.scale {
            span { (short(scale.ends[0])) }
            span.ramp style=(format!("background:linear-gradient(90deg,{})", colours.join(","))) {}
            span { (short(scale.ends[1])) " " (scale.label) }
        }
    }
}
