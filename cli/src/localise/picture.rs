use roverlab::geometry::units;
use roverlab::picture::{Picture, Style};
use roverlab::scan::Localisation;
use roverlab::world::{Colour, Scene};

use super::Finding;
use super::job::errors;
use crate::driving::Run;

/// Picture of a run: the world, the path, the last scan at the most probable place, and all places.
pub(crate) fn of(scene: &Scene, run: &Run<Finding>, noise: f64, seed: u64) -> Picture {
    let outline = scene.robots[0].spec.footprint;
    let mut picture = Picture::new(&scene.world);
    let Ok(finding) = &run.ending else {
        run.draw(&mut picture, &scene.robots[0].spec);
        picture.title("Localisation: failed");
        return picture;
    };
    picture.title(match finding.localisation {
        Localisation::One(_) => "Localisation: one place".to_owned(),
        Localisation::Several(count, _) => format!("Localisation: {count} places that look alike"),
        _ => "Localisation: lost".to_owned(),
    });
    let off = errors(run).map_or("-".into(), |(position, _)| format!("{:.1} mm", units::to_mm(position)));
    picture.caption(format!(
        "most probable place {off} off; {} scans, {:.1} s, noise {noise}, seed {seed}",
        finding.scans, run.sim_time
    ));
    let ends = finding.history.iter().skip(1).map(|(time, _)| *time).chain([run.sim_time]);
    for (index, ((from, places), until)) in finding.history.iter().zip(ends).enumerate() {
        // The first hypotheses stay in the still picture, as the final ones were selected from them.
        let first =
            Style::new(Colour::from_hex(0xe2_85_2b)).opacity(0.5).labelled("candidates of the first scan");
        let (style, until) = if index == 0 { (first, f64::INFINITY) } else { (guess(), until) };
        for &place in places {
            picture.during(*from..until).robot_with(place, &outline, style.clone());
        }
    }
    picture.during(run.sim_time..);
    if let Some(best) = finding.localisation.best() {
        picture.points(finding.scan.points().map(|point| best.pose.to_world(point)), Style::lidar());
    }
    for (index, place) in finding.hypotheses.iter().take(finding.localisation.count()).enumerate() {
        let style = if index == 0 { guess().labelled("place found") } else { guess() };
        picture.robot_with(place.pose, &outline, style.clone());
        picture.disc(place.pose.position(), 1.7 * outline.bounding_radius(), style.width(2.4));
    }
    picture.during(..);
    run.draw(&mut picture, &scene.robots[0].spec);
    picture
}

/// Style of a hypothesis.
fn guess() -> Style {
    Style::new(Colour::from_hex(0xd0_60_10))
}
