//! Relations between the answers of a space, and between them and those of other ways to find them.

use std::f64::consts::{PI, TAU};

use parry2d_f64::math::{Pose as ParryPose, Vector as ParryVector};
use parry2d_f64::query::{self, Ray as ParryRay};
use parry2d_f64::shape::SharedShape;
use proptest::prelude::*;

use roverlab::geometry::{Aabb, Point, Pose, Vector, cross, direction};
use roverlab::world::space::{Scanner, Solid, SolidId, Space, Span};
use roverlab::world::{Colour, Footprint, Object, ObjectKind, Shape, Wall, World};

const Z: f64 = 0.1;
const LOW: Span = Span { bottom: 0.0, top: 0.1 };

/// Walls of a small world: some join, some lie along an axis, some are bare lines or points.
fn walls() -> impl Strategy<Value = Vec<Wall>> {
    let corner =
        || (-8..=8i32, -8..=8i32).prop_map(|(x, y)| Point::new(f64::from(x) * 0.5, f64::from(y) * 0.5));
    let free = || (-5.0..5.0f64, -5.0..5.0f64).prop_map(|(x, y)| Point::new(x, y));
    let line = prop_oneof![(corner(), corner()), (corner(), free()), (free(), free())];
    let thickness = prop_oneof![Just(0.0), Just(Wall::DEFAULT_THICKNESS), 0.0..0.4f64];
    let wall = (line, thickness, prop_oneof![Just(0.2), 0.0..0.3f64])
        .prop_map(|((a, b), thickness, height)| Wall { thickness, height, ..Wall::new(a, b) });
    prop::collection::vec(wall, 0..40)
}

fn pose() -> impl Strategy<Value = Pose> + Clone {
    (-6.0..6.0f64, -6.0..6.0f64, -PI..PI).prop_map(|(x, y, heading)| Pose::new(x, y, heading))
}

fn outline() -> impl Strategy<Value = Footprint> + Clone {
    let rectangle =
        (-0.5..0.5f64, -0.5..0.5f64, 0.0..1.0f64, 0.0..1.0f64).prop_map(|(x, y, length, width)| {
            Footprint::Rectangle(Aabb::new(Point::new(x, y), Point::new(x + length, y + width)))
        });
    prop_oneof![(0.01..0.5f64).prop_map(|radius| Footprint::Disc { radius }), rectangle]
}

fn solids() -> impl Strategy<Value = Vec<Solid>> {
    let solid = (outline(), pose(), 0.0..0.1f64, 0.05..0.3f64)
        .prop_map(|(outline, pose, bottom, height)| Solid::new(outline, pose, bottom, bottom + height));
    // Many of them are looked at by the cells they are in, few one by one.
    prop_oneof![prop::collection::vec(solid.clone(), 0..20), prop::collection::vec(solid, 65..150)]
}

fn filled(walls: &[Wall], solids: &[Solid]) -> Space {
    let mut space = Space::new(walls);
    for solid in solids {
        space.add(*solid);
    }
    space
}

/// Everything in a world at a height, as parry has it.
fn parry_shapes(walls: &[Wall], solids: &[Solid], z: f64) -> Vec<(ParryPose, SharedShape)> {
    let world = World { walls: walls.to_vec(), ..World::empty(1.0, 1.0) };
    let solids = solids.iter().filter(|s| s.span().contains(z)).map(|s| parry_shape(&s.outline, &s.pose));
    world.parry_shapes(z).into_iter().chain(solids).collect()
}

fn parry_shape(outline: &Footprint, pose: &Pose) -> (ParryPose, SharedShape) {
    match outline {
        Footprint::Disc { radius } => {
            (ParryPose::new(ParryVector::new(pose.x, pose.y), 0.0), SharedShape::ball(*radius))
        }
        Footprint::Rectangle(r) => {
            let middle = pose.to_world(r.min + r.size() * 0.5);
            let half = r.size() * 0.5;
            (
                ParryPose::new(ParryVector::new(middle.x, middle.y), pose.heading),
                SharedShape::cuboid(half.x, half.y),
            )
        }
        _ => unreachable!("no other outline is drawn here"),
    }
}

#[test]
fn shapes_of_a_world_come_back_and_others_are_named() {
    let shapes = [Shape::Sphere { radius: 0.1 }, Shape::Cone { radius: 0.2, top: 0.1, height: 0.2 }];
    let mut world = World::walled(3.0, 2.0);
    for (x, shape) in (1..).zip(shapes) {
        let kind = ObjectKind::new("thing", shape, Colour::RED);
        world.objects.push(Object::new(kind.into(), Pose::new(f64::from(x), 1.0, 0.5)));
    }
    let mut again = World::empty(3.0, 2.0);
    for (pose, shape) in world.parry_shapes(0.1) {
        again.add_parry_shape(pose, &*shape).unwrap();
    }
    for (wall, back) in world.walls.iter().zip(&again.walls) {
        assert!((wall.line.a - back.line.a).norm() < 1e-12 && (wall.line.b - back.line.b).norm() < 1e-12);
        assert_eq!(wall.thickness, back.thickness);
    }
    let radii: Vec<f64> = again.objects.iter().map(|object| object.kind.shape.bounding_radius()).collect();
    assert!((radii[0] - 0.1).abs() < 1e-12 && (radii[1] - 0.15).abs() < 1e-12, "{radii:?} half way up");
    assert!(world.parry_shapes(0.3).is_empty(), "all is lower");
    let triangle = SharedShape::triangle([0.0, 0.0].into(), [1.0, 0.0].into(), [0.0, 1.0].into());
    again.add_parry_shape(ParryPose::default(), &*triangle).unwrap();
    assert_eq!(again.walls.len(), world.walls.len() + 3);
    let error = again.add_parry_shape(ParryPose::default(), &*SharedShape::capsule_x(1.0, 0.1)).unwrap_err();
    assert!(error.to_string().starts_with("found a Capsule; expected segments"), "{error}");
}

/// The nearest edge of any rectangle's or disc's outline along a ray, one by one.
fn brute_force(walls: &[Wall], solids: &[Solid], eye: Point, d: Vector, z: f64) -> f64 {
    let rectangle = |middle: Point, along: Vector, half: Vector| {
        let (e, f) = (along * half.x, Vector::new(-along.y, along.x) * half.y);
        let corners = [middle + e + f, middle - e + f, middle - e - f, middle + e - f];
        let seen = eye - middle;
        if along.dot(&seen).abs() <= half.x && cross(along, seen).abs() <= half.y {
            return 0.0;
        }
        (0..4).map(|i| edge(corners[i], corners[(i + 1) % 4], eye, d)).fold(f64::INFINITY, f64::min)
    };
    let walls = walls.iter().filter(|wall| z <= wall.height).map(|wall| {
        let along = wall.line.b - wall.line.a;
        let length = along.norm();
        let unit = if length > 0.0 { along / length } else { Vector::x() };
        rectangle(wall.line.a + along * 0.5, unit, Vector::new(0.5 * length, 0.5 * wall.thickness))
    });
    let solids = solids.iter().filter(|s| s.bottom <= z && z <= s.top).map(|s| match s.outline {
        Footprint::Disc { radius } => {
            let g = s.pose.position() - eye;
            let root = radius * radius - cross(d, g) * cross(d, g);
            let near = d.dot(&g) - root.sqrt();
            let inside = g.norm() <= radius;
            if inside {
                0.0
            } else if root >= 0.0 && near > 0.0 {
                near
            } else {
                f64::INFINITY
            }
        }
        Footprint::Rectangle(r) => {
            rectangle(s.pose.to_world(r.min + r.size() * 0.5), s.pose.forward(), r.size() * 0.5)
        }
        _ => unreachable!("no other outline is drawn here"),
    });
    walls.chain(solids).fold(f64::INFINITY, f64::min)
}

/// The distance along a ray to an edge.
fn edge(a: Point, b: Point, eye: Point, d: Vector) -> f64 {
    let (p, q) = (cross(d, a - eye), cross(d, b - eye));
    let ahead = |point: Point| {
        let distance = d.dot(&(point - eye));
        if distance >= 0.0 { distance } else { f64::INFINITY }
    };
    if p == 0.0 && q == 0.0 {
        ahead(a).min(ahead(b))
    } else if p * q > 0.0 {
        f64::INFINITY
    } else {
        ahead(a + (b - a) * (p / (p - q)))
    }
}

/// Whether a range is what rays give: the ray itself to 1 nm, or, where an edge is only just hit or missed or
/// a face is grazed, rays beside it.
fn agrees(range: f64, angle: f64, max_range: f64, cast: impl Fn(Vector) -> f64) -> bool {
    let limited = |r: f64| if r <= max_range { r } else { f64::INFINITY };
    let same = |a: f64, b: f64| a == b || (a - b).abs() < 1e-9;
    let at = |offset: f64| cast(direction(angle + offset));
    if same(range, limited(at(0.0))) {
        return true;
    }
    let near = [at(-2e-9), at(0.0), at(2e-9)];
    let (low, high) = near.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), &r| (l.min(r), h.max(r)));
    let just_out_of_reach = low <= max_range + 1e-9 && max_range - 1e-9 <= high;
    near.iter().any(|&r| (range - r).abs() < 1e-6 || limited(r) == range)
        || (low <= range && range <= high && high - low < 1e-3)
        || (range == f64::INFINITY && just_out_of_reach)
}

proptest! {
    #![proptest_config(roverlab::testing::cases(96))]

    #[test]
    fn a_scan_equals_as_many_rays(
        walls in walls(), solids in solids(), pose in pose(), beams in 1..200usize, first in -4.0..4.0f64,
        max_range in 0.5..15.0f64,
    ) {
        let space = filled(&walls, &solids);
        let increment = TAU / 180.0;
        let mut scanner = Scanner::new(first, increment, beams, Z, 0.0, max_range);
        let mut ranges = vec![0.0; beams];
        space.scan(&mut scanner, &pose, None, &mut ranges);
        let shapes = parry_shapes(&walls, &solids, Z);
        for (beam, &range) in ranges.iter().enumerate() {
            let angle = pose.heading + first + increment * beam as f64;
            let eye = pose.position();
            let own = agrees(range, angle, max_range, |d| space.cast_ray(eye, d, Z, max_range, None));
            prop_assert!(own, "beam {beam}: {range} and ray {}", space.cast_ray(eye, direction(angle), Z, max_range, None));
            let brute = agrees(range, angle, max_range, |d| brute_force(&walls, &solids, eye, d, Z));
            prop_assert!(brute, "beam {beam}: {range} and edges {}", brute_force(&walls, &solids, eye, direction(angle), Z));
            let parry = |d: Vector| {
                let ray = ParryRay::new(ParryVector::new(eye.x, eye.y), ParryVector::new(d.x, d.y));
                let casts = shapes.iter().filter_map(|(pose, shape)| shape.cast_ray(pose, &ray, 100.0, true));
                casts.fold(f64::INFINITY, f64::min)
            };
            prop_assert!(agrees(range, angle, max_range, parry), "beam {beam}: {range} and parry {}", parry(direction(angle)));
        }
    }

    #[test]
    fn rays_from_anywhere_equal_a_look_at_every_edge(
        walls in walls(), solids in solids(),
        x in prop_oneof![-5.0..5.0f64, -100.0..100.0f64, Just(0.5), Just(-4.0)],
        y in prop_oneof![-5.0..5.0f64, -100.0..100.0f64, Just(1.0), Just(4.0)],
        angle in prop_oneof![-PI..PI, (-4..=4i32).prop_map(|quarter| f64::from(quarter) * PI / 2.0)],
    ) {
        let space = filled(&walls, &solids);
        let eye = Point::new(x, y);
        // Whether a point is on a bare line is a matter of rounding.
        prop_assume!(walls.iter().all(|wall| wall.thickness > 0.0 || wall.line.distance_to(eye) > 1e-9));
        let range = space.cast_ray(eye, direction(angle), Z, 300.0, None);
        // On a border, rounding decides between inside and outside; so may a step of 1 nm.
        let steps = [(0.0, 0.0), (1e-9, 0.0), (-1e-9, 0.0), (0.0, 1e-9), (0.0, -1e-9)];
        let agrees = steps.iter().any(|&(dx, dy)| {
            let eye = eye + Vector::new(dx, dy);
            agrees(range, angle, 300.0, |d| brute_force(&walls, &solids, eye, d, Z))
        });
        prop_assert!(agrees, "{range} and {}", brute_force(&walls, &solids, eye, direction(angle), Z));
    }

    #[test]
    fn answers_do_not_depend_on_how_solids_came_to_their_places(
        walls in walls(), solids in solids(), detours in prop::collection::vec((0..30usize, pose(), 0..4u32), 0..60),
        viewpoint in pose(), outline in outline(),
    ) {
        let straight = filled(&walls, &solids);
        let mut moved = Space::new(&walls);
        let ids: Vec<SolidId> = solids.iter().map(|s| moved.add(Solid { pose: Pose::default(), ..*s })).collect();
        for (which, pose, far) in detours {
            if let Some(&id) = ids.get(which) {
                let scale = f64::from(1000_u32.pow(far));
                moved.set_pose(id, Pose::new(pose.x * scale, pose.y * scale, pose.heading));
            }
        }
        for (&id, solid) in ids.iter().zip(&solids).rev() {
            moved.set_pose(id, solid.pose);
        }
        let mut scanner = Scanner::new(0.0, TAU / 90.0, 90, Z, 0.0, 10.0);
        let (mut a, mut b) = ([0.0; 90], [0.0; 90]);
        straight.scan(&mut scanner, &viewpoint, None, &mut a);
        moved.scan(&mut scanner, &viewpoint, None, &mut b);
        prop_assert_eq!(a.map(f64::to_bits), b.map(f64::to_bits));
        let ray = |space: &Space| space.cast_ray(viewpoint.position(), viewpoint.forward(), Z, 20.0, None).to_bits();
        prop_assert_eq!(ray(&straight), ray(&moved));
        let (mut c, mut d) = (Vec::new(), Vec::new());
        straight.contacts(&outline, &viewpoint, LOW, None, &mut c);
        moved.contacts(&outline, &viewpoint, LOW, None, &mut d);
        prop_assert_eq!(c, d);
    }

    #[test]
    fn clearance_is_parrys_distance_and_contacts_lead_out(
        walls in walls(), solids in solids(), outline in outline(), pose in pose(), limit in 0.0..3.0f64,
    ) {
        let space = filled(&walls, &solids);
        let span = Span { bottom: Z - 1e-9, top: Z + 1e-9 };
        let (own_pose, own) = parry_shape(&outline, &pose);
        let nearest = parry_shapes(&walls, &solids, Z).iter().map(|(other_pose, other)| {
            query::distance(&own_pose, &*own, other_pose, &**other).expect("parry knows these shapes").distance
        }).fold(limit, f64::min);
        let clearance = space.clearance(&outline, &pose, span, limit, None);
        prop_assert!((clearance - nearest).abs() < 1e-6, "{clearance} and {nearest}");
        let mut contacts = Vec::new();
        space.contacts(&outline, &pose, span, None, &mut contacts);
        prop_assert_eq!(contacts.is_empty(), clearance > 0.0 || limit == 0.0 && nearest > 0.0);
        for contact in contacts {
            prop_assert!((contact.normal.norm() - 1.0).abs() < 1e-9 && contact.depth >= 0.0);
            let out = contact.normal * (contact.depth + 1e-9);
            let moved = Pose::new(pose.x + out.x, pose.y + out.y, pose.heading);
            let mut left = Vec::new();
            space.contacts(&outline, &moved, span, None, &mut left);
            if let Some(id) = contact.with {
                prop_assert!(left.iter().all(|other| other.with != Some(id)));
            } else {
                let deepest = left.iter().filter(|c| c.with.is_none() && c.normal == contact.normal);
                prop_assert!(deepest.into_iter().all(|c| c.depth != contact.depth));
            }
        }
    }
}

/// A crowd on a floor with some walls, from the same numbers every time.
fn crowd(walls: &[Wall], robots: usize) -> Space {
    let mut stream = roverlab::random::Stream::new(11);
    let mut space = Space::new(walls);
    for _ in 0..robots {
        let pose = Pose::new(stream.between(-5.0, 5.0), stream.between(-5.0, 5.0), stream.between(-PI, PI));
        let radius = stream.between(0.01, 0.08);
        let rectangle = Aabb::new(Point::new(-radius, -radius), Point::new(2.0 * radius, radius));
        let outline =
            if stream.chance(0.5) { Footprint::Disc { radius } } else { Footprint::Rectangle(rectangle) };
        space.add(Solid::new(outline, pose, 0.0, 0.2));
    }
    space
}

#[test]
fn scans_in_a_crowd_equal_rays() {
    let walls: Vec<Wall> = (-4..4)
        .map(|i| Wall::new(Point::new(f64::from(i), -3.0), Point::new(f64::from(i), 2.0 + f64::from(i))))
        .collect();
    let mut stream = roverlab::random::Stream::new(12);
    for robots in [65, 300, 3000] {
        let space = crowd(&walls, robots);
        let mut scanner = Scanner::new(0.0, TAU / 360.0, 360, Z, 0.0, 8.0);
        let mut ranges = [0.0; 360];
        for _ in 0..40 {
            let pose =
                Pose::new(stream.between(-5.5, 5.5), stream.between(-5.5, 5.5), stream.between(-PI, PI));
            space.scan(&mut scanner, &pose, None, &mut ranges);
            for (beam, &range) in ranges.iter().enumerate() {
                let angle = pose.heading + TAU / 360.0 * beam as f64;
                let ray = |d: Vector| space.cast_ray(pose.position(), d, Z, 8.0, None);
                assert!(agrees(range, angle, 8.0, ray), "{robots} robots, beam {beam}: {range}");
            }
        }
    }
}
