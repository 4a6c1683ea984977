use roverlab::geometry::{Aabb, Point, Pose};
use roverlab::world::{DriveSpec, Footprint, HeightField, Object, RobotPlacement, Scene, Shape, Wall};
use serde_json::{Value, json};

/// A scene for the page, in metres and radians.
pub fn scene_json(scene: &Scene) -> Value {
    let world = &scene.world;
    let mut json = json!({
        "floor": corners(&world.floor),
        "bounds": corners(&world.site()),
        "walls": world.walls.iter().map(wall).collect::<Vec<_>>(),
        "objects": world.objects.iter().map(object).collect::<Vec<_>>(),
        "markers": world.markers.iter().map(|marker| json!({
            "at": [marker.position.x, marker.position.y],
            "colour": marker.colour.to_string(),
        })).collect::<Vec<_>>(),
        "boards": world.billboards.iter().map(|board| json!({
            "pose": pose(&board.pose),
            "width": board.width,
        })).collect::<Vec<_>>(),
        "places": world.places.iter().map(|place| json!({
            "letter": place.letter,
            "at": [place.position.x, place.position.y],
        })).collect::<Vec<_>>(),
        "robots": scene.robots.iter().map(robot).collect::<Vec<_>>(),
    });
    if let Some(surface) = world.terrain.as_ref().and_then(|terrain| terrain.surface.as_deref()) {
        json["relief"] = relief(surface);
    }
    json
}

/// Hills as elevations in whole millimetres, row by row from the lower left.
fn relief(surface: &HeightField) -> Value {
    /// Maximum number of samples along a side.
    const MOST: usize = 160;
    let area = surface.area();
    let [columns, rows] = [surface.columns(), surface.rows()].map(|samples| samples.min(MOST));
    let at = |low: f64, high: f64, index: usize, samples: usize| {
        low + (high - low) * index as f64 / (samples - 1) as f64
    };
    let heights = (0..rows).flat_map(|row| {
        (0..columns).map(move |column| {
            let x = at(area.min.x, area.max.x, column, columns);
            let y = at(area.min.y, area.max.y, row, rows);
            surface.height(Point::new(x, y)).map_or(0.0, |height| (1000.0 * height).round())
        })
    });
    json!({ "area": corners(&area), "columns": columns, "heights": heights.collect::<Vec<_>>() })
}

fn corners(bounds: &Aabb) -> [f64; 4] {
    [bounds.min.x, bounds.min.y, bounds.max.x, bounds.max.y]
}

fn pose(pose: &Pose) -> [f64; 3] {
    [pose.x, pose.y, pose.heading]
}

fn wall(wall: &Wall) -> Value {
    let (a, b) = (wall.line.a, wall.line.b);
    json!([a.x, a.y, b.x, b.y, wall.thickness, wall.colour.to_string()])
}

fn object(object: &Object) -> Value {
    let kind = &object.kind;
    let size = match kind.shape {
        Shape::Box { length, width, .. } => json!([length, width]),
        shape => json!(shape.bounding_radius()),
    };
    json!({ "name": kind.name, "pose": pose(&object.pose), "size": size, "colour": kind.colour.to_string() })
}

fn robot(robot: &RobotPlacement) -> Value {
    let spec = &robot.spec;
    let outline = match &spec.footprint {
        Footprint::Disc { radius } => json!(radius),
        Footprint::Rectangle(rectangle) => json!(corners(rectangle)),
        other => json!(other.bounding_radius()),
    };
    let (kind, wheel, track, wheelbase) = match spec.drive {
        DriveSpec::Differential { wheel_diameter, track, .. } => ("differential", wheel_diameter, track, 0.0),
        DriveSpec::Ackermann { wheel_diameter, track, wheelbase, .. } => {
            ("car", wheel_diameter, track, wheelbase)
        }
        DriveSpec::Omni { wheel_diameter, track, wheelbase, .. } => {
            ("omni", wheel_diameter, track, wheelbase)
        }
        DriveSpec::Craft(_) => ("craft", 0.0, 0.0, 0.0),
        _ => ("other", 0.0, 0.0, 0.0),
    };
    let psds = spec.psds.iter().map(|psd| {
        json!({ "id": psd.id, "name": psd.name, "at": [psd.mount.x, psd.mount.y, psd.mount.yaw], "range": psd.max_range })
    });
    json!({
        "name": spec.name,
        "pose": pose(&robot.pose),
        "outline": outline,
        "drive": kind,
        "wheel": wheel,
        "track": track,
        "wheelbase": wheelbase,
        "psds": psds.collect::<Vec<_>>(),
        "lidar": spec.lidar.map(|lidar| json!([lidar.mount.x, lidar.mount.y, lidar.mount.yaw])),
        "camera": spec.camera.map(|camera| json!([camera.mount.x, camera.mount.y, camera.mount.yaw, camera.field_of_view])),
    })
}
