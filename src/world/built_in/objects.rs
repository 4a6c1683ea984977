use std::sync::Arc;

use super::signs::Sign;
use crate::world::{Colour, Mesh, ObjectKind, Shape};

/// Colour of orange cones.
const ORANGE: Colour = Colour::from_hex(0xff_6a_00);
/// Colour of blue cones.
const BLUE: Colour = Colour::from_hex(0x12_4f_c8);
/// Colour of yellow cones.
const YELLOW: Colour = Colour::from_hex(0xff_d4_00);
/// Colour of green cones.
const GREEN: Colour = Colour::from_hex(0x1c_9a_3c);
/// Colour of crates.
const WOOD: Colour = Colour::from_hex(0x9c_6b_30);

impl ObjectKind {
    /// Objects that every scene knows by name. The masses of balls and boxes and the sizes of cones and signs
    /// are those of real ones, or of models that suit the robots.
    pub const PREDEFINED: [&'static str; 22] = [
        "can",
        "soccer",
        "golf",
        "tennis",
        "ball",
        "crate",
        "Crate1",
        "Crate2",
        "Crate3",
        "Cone-O",
        "Cone-B",
        "Cone-Y",
        "Cone-R",
        "Cone-G",
        "Cone-OL",
        "StopSign",
        "GiveWaySign",
        "ParkingSign",
        "NoParkingSign",
        "PedestrianSign",
        "SpeedLimitSign",
        "CancelSpeedLimitSign",
    ];

    /// An object of [`PREDEFINED`](Self::PREDEFINED), case-insensitive, or by the name of its file in
    /// EyeSim's folders, such as `coneorange`.
    pub fn predefined(name: &str) -> Option<Self> {
        let name = file_name(name).unwrap_or(name);
        let known = Self::PREDEFINED.into_iter().find(|known| known.eq_ignore_ascii_case(name))?;
        let cube = |side| Shape::Box { length: side, width: side, height: side };
        let (shape, colour, mass) = match known {
            "can" => (Shape::Cylinder { radius: 0.033, height: 0.115 }, Colour::RED, 0.4),
            "soccer" => (Shape::Sphere { radius: 0.110 }, Colour::WHITE, 0.43),
            "golf" => (Shape::Sphere { radius: 0.0215 }, Colour::from_hex(0xff_a5_00), 0.046),
            "tennis" => (Shape::Sphere { radius: 0.0335 }, Colour::from_hex(0xc8_e0_2a), 0.058),
            "ball" => (Shape::Sphere { radius: 0.050 }, Colour::RED, 0.1),
            "crate" | "Crate1" => (cube(0.2), WOOD, 2.0),
            "Crate2" => (cube(0.3), WOOD, 4.0),
            "Crate3" => (cube(0.4), WOOD, 8.0),
            "Cone-O" => return Some(cone(known, ORANGE, 1.0)),
            "Cone-B" => return Some(cone(known, BLUE, 1.0)),
            "Cone-Y" => return Some(cone(known, YELLOW, 1.0)),
            "Cone-R" => return Some(cone(known, Colour::RED, 1.0)),
            "Cone-G" => return Some(cone(known, GREEN, 1.0)),
            "Cone-OL" => return Some(cone(known, ORANGE, 0.505 / 0.325)),
            _ => return Sign::named(known).map(|sign| sign_on_a_post(known, sign)),
        };
        Some(Self { mass, ..Self::new(known, shape, colour) })
    }
}

/// Object name for an EyeSim file name.
fn file_name(name: &str) -> Option<&'static str> {
    /// File names in scripts, and the corresponding names here.
    const FILES: [(&str, &str); 8] = [
        ("coneorange", "Cone-O"),
        ("coneblue", "Cone-B"),
        ("coneyellow", "Cone-Y"),
        ("conered", "Cone-R"),
        ("conegreen", "Cone-G"),
        ("cone", "Cone-O"),
        ("cancelspeedlimit", "CancelSpeedLimitSign"),
        ("speedlimit", "SpeedLimitSign"),
    ];
    FILES.into_iter().find(|(file, _)| file.eq_ignore_ascii_case(name)).map(|(_, name)| name)
}

/// A traffic cone of a Formula Student track, or one `scale` times as large. For sensors other than cameras
/// it is a round cone with the area of its square foot.
fn cone(name: &str, colour: Colour, scale: f64) -> ObjectKind {
    let (half, height, plate) = (0.114 * scale, 0.325 * scale, 0.030 * scale);
    let shape = Shape::Cone { radius: 0.129 * scale, top: 0.025 * scale, height };
    let mut mesh = Mesh::default();
    let (body, band) = (mesh.paint(colour, None), mesh.paint(band(colour), None));
    mesh.cuboid([-half, -half, 0.0], [half, half, plate], body);
    let ring = |share: f64| {
        let (foot, tip) = (0.080 * scale, 0.022 * scale);
        [foot + share * (tip - foot), plate + share * (height - plate)]
    };
    mesh.turned(&[ring(0.0), ring(0.42)], body);
    mesh.turned(&[ring(0.42), ring(0.7)], band);
    mesh.turned(&[ring(0.7), ring(1.0), [0.0, height]], body);
    ObjectKind {
        mass: 0.45 * scale * scale * scale,
        falls: true,
        mesh: Some(Arc::new(mesh)),
        ..ObjectKind::new(name, shape, colour)
    }
}

/// Colour of a cone's reflecting band: white, or black on cones with too little contrast.
fn band(colour: Colour) -> Colour {
    if colour == YELLOW { Colour::from_hex(0x20_20_20) } else { Colour::WHITE }
}

/// A sign on a post, placed beside the way of its readers: its picture faces against its heading.
fn sign_on_a_post(name: &str, sign: Sign) -> ObjectKind {
    let (radius, height, half, thickness) = (0.0045, 0.430, 0.065, 0.0005);
    let mut mesh = Mesh::default();
    let (gray, picture) =
        (mesh.paint(Colour::from_hex(0x90_90_90), None), mesh.paint(Colour::WHITE, Some(sign.picture())));
    let back = mesh.paint(Colour::from_hex(0x90_90_90), Some(sign.picture_from_behind()));
    mesh.turned(&[[radius, 0.0], [radius, height], [0.0, height]], gray);
    let plate = |x: f64, left: f64| {
        let (top, foot) = (height, height - 2.0 * half);
        [[x, left, top], [x, left, foot], [x, -left, foot], [x, -left, top]]
    };
    // Seen along the heading, left is on the left.
    mesh.quadrangle(plate(-radius - thickness, half), picture);
    mesh.quadrangle(plate(-radius, -half), back);
    let shape = Shape::Cylinder { radius, height };
    ObjectKind {
        mass: 2.0,
        mesh: Some(Arc::new(mesh)),
        ..ObjectKind::new(name, shape, Colour::from_hex(0x90_90_90))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_an_object_no_larger_than_it_looks() {
        for name in ObjectKind::PREDEFINED {
            let kind = ObjectKind::predefined(&name.to_lowercase()).unwrap();
            assert_eq!(kind.name, name);
            let Some(mesh) = &kind.mesh else { continue };
            assert!(mesh.faces.iter().all(|face| face.material < mesh.materials.len()), "{name}");
            let top =
                mesh.faces.iter().flat_map(|face| face.corners).map(|corner| corner[2]).fold(0.0, f64::max);
            assert!((top - kind.shape.height()).abs() < 1e-9, "{name}: {top}");
        }
        assert_eq!(ObjectKind::predefined("ConeOrange").unwrap().name, "Cone-O");
        assert!(ObjectKind::predefined("tree").is_none());
    }
}
