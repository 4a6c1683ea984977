use roverlab::geometry::units;
use roverlab::picture::{Mark, Picture, Style};
use roverlab::scan::Localisation;
use roverlab::world::{Colour, Scene};

use super::Finding;
use super::job::errors;
use crate::driving::Run;

/// A picture of a run: the world, the way, the last scan as the most probable place shows it, and all places.
pub(crate) fn of(scene: &Scene, run: &Run<Finding>, noise: f64, seed: u64) -> Picture {
    let outline = scene.robots[0].spec.footprint;
    let mut picture = Picture::new(&scene.world);
    let Ok(finding) = &run.ending else {
        picture.title("Localisation: failed").true_path(run.positions());
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
    picture.true_path(run.positions());
    if let Some(best) = finding.localisation.best() {
        picture.points(finding.scan.points().map(|point| best.pose.to_world(point)), Style::lidar());
    }
    picture.robot(run.truth.pose, &outline);
    for (index, place) in finding.hypotheses.iter().take(finding.localisation.count()).enumerate() {
        let style = Style::new(Colour::from_hex(0xd0_60_10)).width(2.0);
        let style = if index == 0 { style.labelled("place found") } else { style };
        picture.robot_with(place.pose, &outline, style);
    }
    picture.mark(Mark::Start, scene.robots[0].pose.position());
    for &point in &run.truth.contact_places {
        picture.mark(Mark::Contact, point);
    }
    picture
}
