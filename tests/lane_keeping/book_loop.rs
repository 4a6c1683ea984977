//! The book's loop at a scale of about 2:1, as its published picture shows it.

use std::path::Path;

use image::RgbaImage;
use roverlab::geometry::Pose;
use roverlab::world::road::{Alignment, Element, RoadCourse, Traffic};

/// Side of the picture (m).
pub(crate) const SIDE: f64 = 3.1;

/// The picture, from published data.
pub(crate) fn picture() -> RgbaImage {
    let data = std::env::var_os("ROVERLAB_DATA").expect("ROVERLAB_DATA names the folder of published data");
    let image = Path::new(&data).join("worlds/carolo/carolo.png");
    image::open(image).unwrap().into_rgba8()
}

/// The middle of the road.
pub(crate) fn course() -> RoadCourse {
    let line = vec![
        Element::straight(0.7880),
        Element::arc(0.3938, -2.3664),
        Element::straight(1.2924),
        Element::arc(0.3956, -2.3430),
        Element::straight(0.3543),
        Element::arc(0.4429, -2.3825),
        Element::straight(1.2267),
        Element::arc(0.3938, -2.3289),
        Element::straight(1.7714),
        Element::arc(0.3956, -1.5718),
        Element::straight(1.2105),
        Element::arc(0.5905, -1.5738),
        Element::straight(0.7880),
    ];
    RoadCourse {
        traffic: Traffic::Left,
        size: 0.471,
        line: Alignment::new(Pose::new(1.4540, 0.4570, -3.1446), line),
        lane_width: 0.1781,
        line_width: 0.0197,
        centre: Vec::new(),
        marks: Vec::new(),
    }
}
