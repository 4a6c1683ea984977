use std::fmt::Write as _;

use roverlab::geometry::units;
use roverlab::picture::{Mark, Picture, SERIES, Style};

use super::place::{Place, middle};
use super::rubric::Rubric;
use super::table::Graded;

const STYLE: &str = "body{font:15px/1.5 sans-serif;max-width:70em;margin:2em auto;padding:0 1em;color:#222}\
table{border-collapse:collapse;width:100%}th,td{padding:.3em .6em;border-bottom:1px solid #ccc;text-align:left}\
td.n{text-align:right}tr.bad td{background:#fbeeee}figure{display:inline-block;margin:1em;width:30em}\
figure svg{width:100%;height:auto}";

/// The table and a picture of each program in each world, on one page without other files.
pub(super) fn page(rubric: &Rubric, places: &[Place], graded: &[Graded]) -> String {
    let title = escaped(&rubric.title);
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>{title}</title>\
         <style>{STYLE}</style>\n<h1>{title}</h1>\n<p>{} in {} of a kind, noise {}, at most {} s.</p>\n\
         <table><tr><th>program<th>reached<th>contacts<th>time<th>path / shortest<th>otherwise<th>output<th>remarks</tr>\n",
        escaped(&rubric.robot),
        rubric.seeds,
        rubric.noise,
        rubric.time_limit
    );
    for program in graded {
        page += &row(program, places);
    }
    page += "</table>\n";
    for program in graded {
        // Writing to a string cannot fail.
        let _ = writeln!(page, "<h2>{}</h2>", escaped(&program.name));
        for index in 0..places.len() {
            let _ = writeln!(page, "<figure>{}</figure>", picture(program, places, index).to_svg());
        }
    }
    page + "</html>\n"
}

fn row(program: &Graded, places: &[Place]) -> String {
    let number =
        |value: Option<f64>, unit: &str| value.map_or("–".into(), |value| format!("{value:.2}{unit}"));
    let class = if program.reached() == program.runs.len() { "" } else { " class=bad" };
    format!(
        "<tr{class}><td>{}<td class=n>{}/{}<td class=n>{}<td class=n>{}<td class=n>{}<td>{}<td>{}<td>{}</tr>\n",
        escaped(&program.name),
        program.reached(),
        program.runs.len(),
        program.contacts(),
        number(program.time(), " s"),
        number(program.ratio(places), ""),
        escaped(&program.others()),
        escaped(program.output()),
        escaped(&program.remarks())
    )
}

/// The paths of a program in a world, and the places to come to.
pub(super) fn picture(program: &Graded, places: &[Place], index: usize) -> Picture {
    let place = &places[index];
    let mut picture = Picture::new(&place.scene.world);
    let runs = || program.runs.iter().filter(move |ran| ran.place == index);
    let reached = runs().filter(|ran| ran.outcome == "reached").count();
    picture.title(program.name.rsplit('/').next().unwrap_or_default());
    picture.caption(format!("{reached} of {} reached", runs().count()));
    for goal in place.task.visit.iter().chain(&place.task.end) {
        picture.disc(middle(goal), units::from_mm(goal[2]), Style::plan().filled(0.1));
    }
    for ran in runs() {
        let colour = if ran.outcome == "reached" { SERIES[1] } else { SERIES[4] };
        let label = if ran.outcome == "reached" { "reached" } else { "not reached" };
        picture.line(ran.path.iter().copied(), Style::new(colour).width(1.2).opacity(0.7).labelled(label));
    }
    let start = &place.scene.robots[0];
    picture.robot(start.pose, &start.spec.footprint).mark(Mark::Start, start.pose.position());
    picture
}

/// A text between tags.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
