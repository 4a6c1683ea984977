use super::shape::{Block, OrientedBox, Shape};
use super::solid::{SolidId, Span};
use super::store::Space;
use crate::geometry::{Aabb, Pose, Vector};
use crate::world::Footprint;

/// Contact or overlap of an outline with an obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Unit vector from the obstacle towards the outline: the shortest way out.
    pub normal: Vector,
    /// Displacement along the normal until the two just touch (m).
    pub depth: f64,
    /// The obstacle; `None` is a wall.
    pub with: Option<SolidId>,
}

/// Parameters of a query.
#[derive(Clone, Copy)]
struct Query {
    shape: Shape,
    span: Span,
    walls: bool,
    solids: bool,
    except: Option<SolidId>,
}

impl Space {
    /// All contacts of an outline at a pose, between two heights, with walls and solids; `out` is cleared
    /// first.
    ///
    /// Walls come first, deepest first, followed by solids in their order. Touching counts, with depth 0;
    /// standing on top of something does not. The solid `except` is ignored.
    pub fn contacts(
        &self,
        outline: &Footprint,
        pose: &Pose,
        span: Span,
        except: Option<SolidId>,
        out: &mut Vec<Contact>,
    ) {
        let query = Query { shape: outline.at(pose), span, walls: true, solids: true, except };
        self.find_contacts(&query, out);
    }

    /// Distance from an outline at a pose, between two heights, to the nearest wall or solid (m): at most
    /// `limit`, and 0 in contact. The solid `except` is ignored.
    pub fn clearance(
        &self,
        outline: &Footprint,
        pose: &Pose,
        span: Span,
        limit: f64,
        except: Option<SolidId>,
    ) -> f64 {
        let (walls, solids) = self.clearances(outline, pose, span, limit, except);
        walls.min(solids)
    }

    /// Like [`clearance`](Self::clearance), for walls only. Walls are static, so an outline that moves (and
    /// turns) by less than this touches none.
    pub fn walls_clearance(&self, outline: &Footprint, pose: &Pose, span: Span, limit: f64) -> f64 {
        let query = Query { shape: outline.at(pose), span, walls: true, solids: false, except: None };
        self.find_clearance(&query, limit)
    }

    /// Like [`clearance`](Self::clearance), for solids only.
    pub fn solids_clearance(
        &self,
        outline: &Footprint,
        pose: &Pose,
        span: Span,
        limit: f64,
        except: Option<SolidId>,
    ) -> f64 {
        let query = Query { shape: outline.at(pose), span, walls: false, solids: true, except };
        self.find_clearance(&query, limit)
    }

    /// [`walls_clearance`](Self::walls_clearance) and [`solids_clearance`](Self::solids_clearance) at once.
    pub(crate) fn clearances(
        &self,
        outline: &Footprint,
        pose: &Pose,
        span: Span,
        limit: f64,
        except: Option<SolidId>,
    ) -> (f64, f64) {
        let query = Query { shape: outline.at(pose), span, walls: true, solids: true, except };
        let (mut walls, mut solids) = (limit, limit);
        self.for_each_near(&query, &query.shape.bounds().inflated(limit), |shape, with| {
            let nearest = if with.is_some() { &mut solids } else { &mut walls };
            *nearest = smaller(*nearest, &query.shape, shape);
        });
        (walls, solids)
    }

    #[inline]
    fn find_contacts(&self, query: &Query, out: &mut Vec<Contact>) {
        out.clear();
        self.for_each_near(query, &query.shape.bounds(), |shape, with| {
            if let Some((normal, depth)) = query.shape.penetration(shape) {
                let contact = Contact { normal, depth, with };
                // A wall is visited in each of its cells.
                if with.is_some() || !out.contains(&contact) {
                    out.push(contact);
                }
            }
        });
        if out.len() > 1 {
            // The order of visits depends on the grid, and therefore on the solids' history.
            out.sort_unstable_by(|a, b| {
                let deepest = b.depth.total_cmp(&a.depth);
                let normals = (a.normal.x.total_cmp(&b.normal.x)).then(a.normal.y.total_cmp(&b.normal.y));
                a.with.cmp(&b.with).then(deepest).then(normals)
            });
        }
    }

    #[inline]
    fn find_clearance(&self, query: &Query, limit: f64) -> f64 {
        let mut nearest = limit;
        let window = query.shape.bounds().inflated(limit);
        self.for_each_near(query, &window, |shape, _| nearest = smaller(nearest, &query.shape, shape));
        nearest
    }

    /// Visits the candidates that may overlap a window and share heights with the query; walls possibly more
    /// than once.
    #[inline]
    fn for_each_near(&self, query: &Query, window: &Aabb, mut visit: impl FnMut(&Shape, Option<SolidId>)) {
        let mut wall = |wall: &Block| {
            if wall.span.overlaps(&query.span) {
                visit(&Shape::Box(wall.shape), None);
            }
        };
        let window_cells = self.grid.lattice.under(window).map(|(cells, _)| cells);
        if query.walls {
            self.grid.loose_walls().iter().for_each(|&number| wall(&self.walls[number as usize]));
            if let Some(cells) = window_cells {
                self.grid.for_each_wall_in(cells, wall);
            }
        }
        if query.solids {
            let mut solid = |number: u32| {
                let placed = &self.solids[number as usize];
                let id = Some(SolidId(number));
                if id != query.except && placed.span.overlaps(&query.span) {
                    visit(&placed.shape, id);
                }
            };
            self.grid.loose_solids().iter().for_each(|&number| solid(number));
            if let Some(cells) = window_cells {
                self.grid.for_each_solid_in(cells, |number, x, y| {
                    // A solid is listed in several cells; it is visited in the first one shared with the
                    // window.
                    let own = self.solids[number as usize].cells;
                    if own.is_some_and(|own| own.meets_first_at(&cells, x, y)) {
                        solid(number);
                    }
                });
            }
        }
    }
}

/// The smaller of a gap and that between two shapes. Nothing is nearer than 0, which many contacts are.
#[inline]
fn smaller(gap: f64, own: &Shape, other: &Shape) -> f64 {
    if gap > 0.0 { gap.min(own.gap(other)) } else { gap }
}

impl Shape {
    /// The way out of another shape, as a unit vector and a depth; `None` without contact.
    #[inline]
    fn penetration(&self, other: &Shape) -> Option<(Vector, f64)> {
        match (self, other) {
            (Shape::Disc { centre, radius }, Shape::Box(other)) => {
                disc_out_of_box(other, other.local(*centre), *radius)
            }
            (Shape::Disc { centre, radius }, Shape::Disc { centre: other, radius: other_radius }) => {
                let apart = centre - other;
                let (distance, reach) = (apart.norm(), radius + other_radius);
                let normal = if distance > 0.0 { apart / distance } else { Vector::x() };
                (distance <= reach).then_some((normal, reach - distance))
            }
            (Shape::Box(own), Shape::Disc { centre, radius }) => {
                let (normal, depth) = disc_out_of_box(own, own.local(*centre), *radius)?;
                Some((-normal, depth))
            }
            (Shape::Box(own), Shape::Box(other)) => box_out_of_box(own, other),
        }
    }

    /// Distance to another shape; 0 in contact.
    #[inline]
    fn gap(&self, other: &Shape) -> f64 {
        match (self, other) {
            (Shape::Disc { centre, radius }, Shape::Disc { centre: other, radius: other_radius }) => {
                ((centre - other).norm() - radius - other_radius).max(0.0)
            }
            (Shape::Disc { centre, radius }, Shape::Box(shape))
            | (Shape::Box(shape), Shape::Disc { centre, radius }) => {
                (outside(shape, shape.local(*centre)).norm() - radius).max(0.0)
            }
            (Shape::Box(a), Shape::Box(b)) => {
                if box_out_of_box(a, b).is_some() {
                    return 0.0;
                }
                // The shortest connection of two disjoint boxes starts at a corner of one of them.
                let from = |corners: &OrientedBox, to: &OrientedBox| {
                    corners.corners().map(|c| outside(to, to.local(c)).norm_squared()).into_iter()
                };
                from(a, b).chain(from(b, a)).fold(f64::INFINITY, f64::min).sqrt()
            }
        }
    }
}

/// How far a point of the box's frame is outside the box, along and across.
#[inline]
fn outside(shape: &OrientedBox, local: Vector) -> Vector {
    Vector::new((local.x.abs() - shape.half.x).max(0.0), (local.y.abs() - shape.half.y).max(0.0))
}

/// The way out of a box for a disc about a point in the box's frame.
#[inline]
fn disc_out_of_box(shape: &OrientedBox, local: Vector, radius: f64) -> Option<(Vector, f64)> {
    let out = outside(shape, local);
    let squared = out.norm_squared();
    if squared > radius * radius {
        return None;
    }
    let signed = |x: f64, like: f64| if like < 0.0 { -x } else { x };
    let (normal, depth) = if squared > 0.0 {
        let distance = squared.sqrt();
        (out / distance, radius - distance)
    } else {
        // The centre is inside: out through the nearest face.
        let (end, side) = (shape.half.x - local.x.abs(), shape.half.y - local.y.abs());
        if side <= end { (Vector::y(), radius + side) } else { (Vector::x(), radius + end) }
    };
    let normal = Vector::new(signed(normal.x, local.x), signed(normal.y, local.y));
    Some((shape.turned(normal), depth))
}

/// The way out of `other` for `own`: along the box axis with the smallest overlap.
fn box_out_of_box(own: &OrientedBox, other: &OrientedBox) -> Option<(Vector, f64)> {
    let apart = own.centre - other.centre;
    let mut best: Option<(Vector, f64)> = None;
    for (face, opposite) in [(other, own), (own, other)] {
        // Half extents of the other box along the axes of this one.
        let (cos, sin) =
            (face.axis.dot(&opposite.axis).abs(), crate::geometry::cross(face.axis, opposite.axis).abs());
        let (h, o) = (face.half, opposite.half);
        let reach_along = h.x + cos * o.x + sin * o.y;
        let reach_across = h.y + sin * o.x + cos * o.y;
        let normal = Vector::new(-face.axis.y, face.axis.x);
        for (axis, reach) in [(face.axis, reach_along), (normal, reach_across)] {
            let offset = apart.dot(&axis);
            let depth = reach - offset.abs();
            if depth < 0.0 {
                return None;
            }
            if best.is_none_or(|(_, least)| depth < least) {
                best = Some((if offset < 0.0 { -axis } else { axis }, depth));
            }
        }
    }
    best
}
