use std::sync::Arc;

use super::ball::draw_ball;
use super::canvas::Canvas;
use super::face::Cutter;
use super::ground::Ground;
use super::model::{Model, Stand};
use super::murk::Murk;
use super::poster::draw_poster;
use super::slanted::{Piece, draw_block, pieces};
use super::solids::{Carpenter, Standing};
use super::view::View;
use crate::geometry::{Aabb, Point, Pose, Vector, direction};
use crate::io::sim::terrain::Hills;
use crate::io::{Error, ErrorKind, Result};
use crate::world::space::{SolidId, Space};
use crate::world::{
    Billboard, Colour, Footprint, HeightField, Marker, Mast, Mesh, Object, RobotPlacement, Scene, Shape,
    Texture, Wall,
};

/// Everything visible in a scene.
#[derive(Debug)]
pub(super) struct Scenery {
    floor: Aabb,
    /// The floor's image.
    floor_texture: Option<Texture>,
    /// Floor and sky; `None` before the first picture.
    ground: Option<Ground>,
    /// The hills that are the ground, if it has any.
    hills: Option<Arc<HeightField>>,
    walls: Vec<([Point; 4], Standing)>,
    /// The same on hills, in pieces that follow the ground.
    pieces: Vec<Piece>,
    markers: Vec<Marker>,
    billboards: Vec<Billboard>,
    things: Vec<Thing>,
    /// Distinct surfaces of things, and their models after the first picture.
    meshes: Vec<Arc<Mesh>>,
    models: Vec<Model>,
    robots: Vec<Thing>,
    /// The water of the world.
    murk: Option<Murk>,
    carpenter: Carpenter,
    cutter: Cutter,
}

/// A thing whose pose is in the space.
#[derive(Debug)]
struct Thing {
    solid: SolidId,
    form: Form,
    height: f64,
    colour: Colour,
    mast: Option<Mast>,
    /// Index of its surface, if it differs from the form.
    model: Option<usize>,
}

#[derive(Debug, Clone, Copy)]
enum Form {
    Ball(f64),
    Cylinder(f64),
    /// Radii of foot and top.
    Cone(f64, f64),
    Cuboid(Aabb),
}

/// Colours that distinguish robots, assigned cyclically.
const ROBOTS: [Colour; 5] = [
    Colour::from_hex(0x2f_6d_b5),
    Colour::from_hex(0x2d_9b_6b),
    Colour::from_hex(0x8a_4f_a3),
    Colour::from_hex(0xb8_8a_1e),
    Colour::from_hex(0x3a_9f_c4),
];
/// Colour of a robot's lower part with the wheels, and its fraction of the height.
const CHASSIS: (Colour, f64) = (Colour::from_hex(0x2a_2a_2e), 0.4);
/// The plate in the middle of a robot's front.
const FRONT_PLATE: Colour = Colour::from_hex(0xf2_f2_f2);
/// Corners of a round robot that leans.
const ROUND: usize = 24;
/// Between which shares of its height a robot's front is.
const FRONT: (f64, f64) = (0.5, 0.92);
/// Radius of a marker (m).
const MARKER: f64 = 0.010;

impl Scenery {
    /// The visible part of a scene; `objects` and `robots` are its solids in the space.
    pub(super) fn new(scene: &Scene, objects: &[SolidId], robots: &[SolidId]) -> Self {
        let world = &scene.world;
        let robots = robots.iter().zip(&scene.robots).enumerate();
        let mut meshes = Vec::new();
        let things =
            objects.iter().zip(&world.objects).map(|(&solid, object)| thing(solid, object, &mut meshes));
        let things = things.collect();
        let robots = robots.map(|(index, (&solid, placed))| robot(index, solid, placed, &mut meshes));
        let robots = robots.collect();
        Self {
            floor: world.floor,
            floor_texture: world.floor_texture.clone(),
            ground: None,
            hills: world.terrain.as_ref().and_then(|terrain| terrain.surface.clone()),
            walls: world.walls.iter().map(wall).collect(),
            pieces: Vec::new(),
            markers: world.markers.clone(),
            billboards: world.billboards.clone(),
            things,
            meshes,
            models: Vec::new(),
            robots,
            murk: Murk::of(world),
            carpenter: Carpenter::default(),
            cutter: Cutter::default(),
        }
    }

    /// Draws the view of a camera mounted on a robot.
    pub(super) fn draw(
        &mut self,
        canvas: &mut Canvas,
        view: &View,
        (space, hills): (&Space, Option<&Hills>),
        me: usize,
    ) -> Result<()> {
        canvas.reset(view.width, view.height);
        if self.ground.is_none() {
            let image = self.floor_texture.as_ref().map(pixels).transpose()?;
            self.ground = Some(Ground::new(self.floor, image, self.hills.clone()));
            if let Some(hills) = &self.hills {
                self.pieces = self.walls.iter().flat_map(|wall| pieces(hills, wall)).collect();
            }
            self.models = self.meshes.iter().map(|mesh| Model::new(mesh)).collect();
        }
        if let Some(ground) = &mut self.ground {
            ground.draw(canvas, view);
        }
        for marker in &self.markers {
            let Marker { position, colour, alpha } = *marker;
            let on_hills = hills.map(|hills| hills.ground_level(position));
            self.carpenter.spot(canvas, view, (position, on_hills), MARKER, (colour, alpha));
        }
        if hills.is_none() {
            for (corners, body) in &self.walls {
                self.carpenter.prism(canvas, view, corners, *body);
            }
        }
        self.pieces.iter().for_each(|piece| piece.draw(&mut self.cutter, canvas, view));
        for thing in &self.things {
            let solid = space.solid(thing.solid);
            match thing.model.and_then(|model| self.models.get(model)) {
                // Fallen things are not drawn.
                _ if solid.top <= solid.bottom => {}
                Some(model) => {
                    let stand = Stand::upright(&solid.pose, foot(space, thing.solid));
                    model.draw(&mut self.cutter, canvas, view, &stand);
                }
                None => thing.draw(&mut self.carpenter, canvas, view, space),
            }
        }
        for (index, robot) in self.robots.iter().enumerate().filter(|&(index, _)| index != me) {
            let solid = space.solid(robot.solid);
            let stand = match hills {
                Some(hills) => Stand::slanted(&hills.pose(index)),
                None => Stand::upright(&solid.pose, solid.bottom),
            };
            match robot.model.and_then(|model| self.models.get(model)) {
                Some(model) => model.draw(&mut self.cutter, canvas, view, &stand),
                None if hills.is_some() => robot.draw_slanted(&mut self.cutter, canvas, view, &stand),
                None => robot.draw_robot(&mut self.carpenter, canvas, view, space),
            }
        }
        for board in &self.billboards {
            let level = hills.map_or(0.0, |hills| hills.ground_level(board.pose.position()));
            draw_poster(&mut self.cutter, canvas, view, board, level);
        }
        if let Some(murk) = &self.murk {
            murk.veil(canvas, view);
        }
        Ok(())
    }
}

impl Thing {
    fn draw(&self, carpenter: &mut Carpenter, canvas: &mut Canvas, view: &View, space: &Space) {
        let solid = space.solid(self.solid);
        let bottom = foot(space, self.solid);
        let whole = Standing { bottom, top: bottom + self.height, colour: self.colour };
        self.draw_part(carpenter, canvas, view, &solid.pose, whole);
    }

    fn draw_robot(&self, carpenter: &mut Carpenter, canvas: &mut Canvas, view: &View, space: &Space) {
        let solid = space.solid(self.solid);
        let waist = solid.bottom + CHASSIS.1 * self.height;
        let lower = Standing { bottom: solid.bottom, top: waist, colour: CHASSIS.0 };
        let upper = Standing { bottom: waist, top: solid.bottom + self.height, colour: self.colour };
        self.draw_part(carpenter, canvas, view, &solid.pose, lower);
        self.draw_part(carpenter, canvas, view, &solid.pose, upper);
        // A white front and a dark back show a robot's heading and rotation.
        let (low, high) = (solid.bottom + FRONT.0 * self.height, solid.bottom + FRONT.1 * self.height);
        for (plate, colour) in self.plates().into_iter().zip([FRONT_PLATE, CHASSIS.0]) {
            let part = Self { form: Form::Cuboid(plate), ..*self };
            let body = Standing { bottom: low, top: high, colour };
            part.draw_part(carpenter, canvas, view, &solid.pose, body);
        }
        if let Some(Mast { outline, top }) = self.mast {
            let mast = Self { form: Form::Cuboid(outline), ..*self };
            let body = Standing { bottom: solid.top, top: solid.bottom + top, colour: CHASSIS.0 };
            mast.draw_part(carpenter, canvas, view, &solid.pose, body);
        }
    }

    /// A robot on hills, which leans as they do.
    fn draw_slanted(&self, cutter: &mut Cutter, canvas: &mut Canvas, view: &View, stand: &Stand) {
        let outline = |form: Form| match form {
            Form::Ball(radius) | Form::Cylinder(radius) | Form::Cone(radius, _) => {
                let step = std::f64::consts::TAU / ROUND as f64;
                (0..ROUND).map(|corner| Point::from(direction(step * corner as f64) * radius)).collect()
            }
            Form::Cuboid(Aabb { min, max }) => {
                vec![min, Point::new(max.x, min.y), max, Point::new(min.x, max.y)]
            }
        };
        let whole = outline(self.form);
        let waist = CHASSIS.1 * self.height;
        let mut block = |outline: &[Point], bottom: f64, top: f64, colour: Colour| {
            draw_block(cutter, canvas, view, (stand, outline), Standing { bottom, top, colour });
        };
        block(&whole, 0.0, waist, CHASSIS.0);
        block(&whole, waist, self.height, self.colour);
        for (plate, colour) in self.plates().into_iter().zip([FRONT_PLATE, CHASSIS.0]) {
            block(&outline(Form::Cuboid(plate)), FRONT.0 * self.height, FRONT.1 * self.height, colour);
        }
        if let Some(Mast { outline: mast, top }) = self.mast {
            block(&outline(Form::Cuboid(mast)), self.height, top, CHASSIS.0);
        }
    }

    /// Boxes in the middle of a robot's front and back that stand out a little.
    fn plates(&self) -> [Aabb; 2] {
        let (ahead, behind, half) = match self.form {
            Form::Ball(radius) | Form::Cylinder(radius) | Form::Cone(radius, _) => {
                (radius, -radius, 0.45 * radius)
            }
            Form::Cuboid(Aabb { min, max }) => (max.x, min.x, 0.22 * (max.y - min.y)),
        };
        [(0.5 * ahead, 1.03 * ahead), (1.03 * behind, 0.5 * behind)]
            .map(|(from, to)| Aabb::new(Point::new(from, -half), Point::new(to, half)))
    }

    fn draw_part(
        &self,
        carpenter: &mut Carpenter,
        canvas: &mut Canvas,
        view: &View,
        pose: &Pose,
        body: Standing,
    ) {
        match self.form {
            Form::Ball(radius) => {
                draw_ball(canvas, view, [pose.x, pose.y, body.bottom + radius], radius, body.colour);
            }
            Form::Cylinder(radius) => carpenter.cylinder(canvas, view, pose.position(), radius, body),
            Form::Cone(foot, top) => carpenter.cone(canvas, view, pose.position(), [foot, top], body),
            Form::Cuboid(Aabb { min, max }) => {
                let forward = direction(pose.heading);
                let left = Vector::new(-forward.y, forward.x);
                let corner = |x: f64, y: f64| pose.position() + forward * x + left * y;
                let corners =
                    [corner(min.x, min.y), corner(max.x, min.y), corner(max.x, max.y), corner(min.x, max.y)];
                carpenter.prism(canvas, view, &corners, body);
            }
        }
    }
}

fn wall(wall: &Wall) -> ([Point; 4], Standing) {
    let (a, b) = (wall.line.a, wall.line.b);
    let along = b - a;
    let length = along.norm();
    let along = if length > 0.0 { along / length } else { Vector::x() };
    let half = Vector::new(-along.y, along.x) * (0.5 * wall.thickness);
    let body = Standing { bottom: 0.0, top: wall.height, colour: wall.colour };
    ([a - half, b - half, b + half, a + half], body)
}

/// Height of a solid's foot above the floor (m).
fn foot(space: &Space, solid: SolidId) -> f64 {
    space.solid(solid).bottom + space.level(solid)
}

fn thing(solid: SolidId, object: &Object, meshes: &mut Vec<Arc<Mesh>>) -> Thing {
    let kind = &object.kind;
    let form = match kind.shape {
        Shape::Sphere { radius } => Form::Ball(radius),
        Shape::Cylinder { radius, .. } => Form::Cylinder(radius),
        Shape::Cone { radius, top, .. } => Form::Cone(radius, top),
        Shape::Box { length, width, .. } => {
            let corner = Point::new(0.5 * length, 0.5 * width);
            Form::Cuboid(Aabb::new(-corner, corner))
        }
    };
    let model = kind.mesh.as_ref().map(|mesh| number(mesh, meshes));
    Thing { solid, form, height: kind.shape.height(), colour: kind.colour, mast: None, model }
}

/// Index of a surface in `meshes`, where it is added if missing.
fn number(mesh: &Arc<Mesh>, meshes: &mut Vec<Arc<Mesh>>) -> usize {
    meshes.iter().position(|known| Arc::ptr_eq(known, mesh)).unwrap_or_else(|| {
        meshes.push(Arc::clone(mesh));
        meshes.len() - 1
    })
}

fn robot(index: usize, solid: SolidId, placed: &RobotPlacement, meshes: &mut Vec<Arc<Mesh>>) -> Thing {
    let form = match placed.spec.footprint {
        Footprint::Disc { radius } => Form::Cylinder(radius),
        Footprint::Rectangle(rectangle) => Form::Cuboid(rectangle),
    };
    let colour = ROBOTS[index % ROBOTS.len()];
    let model = placed.spec.mesh.as_ref().map(|mesh| number(mesh, meshes));
    Thing { solid, form, height: placed.spec.height, colour, mast: placed.spec.mast, model }
}

/// Pixels of the floor's image, which were read with the world's file.
fn pixels(texture: &Texture) -> Result<&image::RgbaImage> {
    texture.image.as_deref().ok_or_else(|| {
        let message = format!("the floor's image {} has not been read", texture.file.display());
        Error::new(ErrorKind::Other, message)
    })
}
