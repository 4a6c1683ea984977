use std::path::Path;

use roverlab::geometry::Point;
use roverlab::io::sim::Truth;
use roverlab::picture::{Picture, SERIES, Style};
use roverlab::world::Scene;

/// Draws the world and the paths of its robots.
pub(super) fn draw(scene: &Scene, world: &Truth, file: &Path) -> Result<(), String> {
    let mut picture = Picture::new(&scene.world);
    picture.title("RoBIOS programs");
    for (index, placed) in scene.robots.iter().enumerate() {
        let Ok(robot) = world.robot(index) else { continue };
        let colour = SERIES[index % SERIES.len()];
        let path: Vec<Point> = robot.trail.iter().map(|point| point.pose.position()).collect();
        let name = placed.program.as_deref().unwrap_or(&placed.spec.name);
        let style = Style::new(colour).labelled(format!("robot {}: {name}", index + 1));
        picture.line(path, style.clone());
        picture.robot_with(robot.pose, &placed.spec.footprint, Style::new(colour));
    }
    picture.save(file).map_err(|error| error.to_string())
}
