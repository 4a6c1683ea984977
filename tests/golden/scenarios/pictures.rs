//! Pictures of worlds and runs.

use super::Scenario;

pub(super) const SCENARIOS: &[Scenario] = &[
    #[cfg(feature = "picture")]
    Scenario::new("picture", picture),
    #[cfg(not(feature = "picture"))]
    Scenario::without("picture", "built without the feature `picture`"),
];

/// Everything that a picture can show, as SVG.
#[cfg(feature = "picture")]
fn picture() -> roverlab::io::Result<String> {
    use roverlab::evolve::chart;
    use roverlab::geometry::{Point, Pose};
    use roverlab::picture::{Mark, Picture, SERIES, Style};
    use roverlab::world::RobotSpec;

    let way =
        |shift: f64| (0..9_u8).map(move |k| Point::new(0.3 * f64::from(k), shift + 0.02 * f64::from(k * k)));
    let mut picture = Picture::new(&super::room());
    picture
        .title("A trip")
        .caption("there & back")
        .true_path(way(0.3))
        .odometry_path(way(0.35))
        .speed_path(way(0.5).zip([0.0, 1.0, 2.0, 4.0, 4.0, 3.0, 2.0, 1.0, 0.0]))
        .line(way(0.1), Style::plan().dashed())
        .points(way(0.6), Style::lidar().labelled("seen"))
        .disc(Point::new(1.0, 1.2), 0.1, Style::new(SERIES[2]).filled(0.4))
        .polygon(way(1.0), Style::new(SERIES[3]).width(2.0))
        .mark(Mark::Start, Point::new(0.3, 0.5))
        .mark_named(Mark::Goal, Point::new(2.7, 1.7), "the goal")
        .text(Point::new(1.5, 1.5), "here")
        .robot(Pose::new(1.2, 0.6, 0.1), &RobotSpec::s4().footprint)
        .robot(Pose::new(2.0, 1.0, -1.1), &RobotSpec::car().footprint);
    Ok(picture.to_svg() + &chart(&[]).to_svg())
}
