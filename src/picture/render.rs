//! Assembles the parts of a picture on a page.

use svg::Document;
use svg::node::element::{ClipPath, Definitions, Group};

use super::canvas::{FONTS, number, rectangle};
use super::colours::PAGE;
use super::decorations::{heading, pace, scale_bar, title_width};
use super::film::Film;
use super::frame::{Frame, GAP, Pixel};
use super::items::{Figure, Item, Picture, is_finite};
use super::legend::{Arrangement, Legend};
use super::lines::{self, Path};
use super::{Mark, names, robots, scenery};
use crate::geometry::{Aabb, Point, Vector};

/// Minimum width of a title (pixels). Narrower plots have their legend beside rather than below them.
const NARROW: f64 = 300.0;
/// Identifier of the outline that clips the plot.
const CLIP: &str = "frame";

impl Picture {
    /// The picture at its end as an SVG document.
    pub fn to_svg(&self) -> String {
        page(&self.at(self.duration()), None)
    }

    /// The picture as an animated SVG document in an endless loop: at the run's pace for up to 14 seconds,
    /// faster otherwise. Still if nothing moves.
    pub fn to_moving_svg(&self) -> String {
        match Film::of(self.duration()) {
            Some(film) => page(self, Some(&film)),
            None => self.to_svg(),
        }
    }

    /// Highest speed along the paths coloured by speed (m/s).
    pub(super) fn top_speed(&self) -> f64 {
        let speeds = self.items.iter().filter_map(|item| match &item.figure {
            Figure::Line { speeds, .. } => Some(speeds),
            _ => None,
        });
        speeds.flatten().copied().fold(0.0, f64::max)
    }
}

fn page(picture: &Picture, film: Option<&Film>) -> String {
    let region = picture.region();
    let wide = Frame::around(region, Pixel::origin()).pixels().size().x;
    let legend = Legend::of(picture);
    let below = if picture.to_scale || film.is_some() { 1.5 * GAP } else { 0.0 };
    let beside = wide < NARROW && !legend.is_empty();
    let (arrangement, wanted) = if beside {
        (Arrangement::Column, wide + GAP + legend.size(Arrangement::Column).x)
    } else {
        (Arrangement::Rows(wide.max(NARROW)), wide)
    };
    let room = wanted.max(title_width(picture)).clamp(NARROW, Frame::WIDEST);
    let (heading, height) = heading(picture, Pixel::new(GAP, GAP), room);
    let frame = Frame::around(region, Pixel::new(GAP, GAP + height));
    let plot = frame.pixels();
    let corner = if beside {
        Pixel::new(plot.max.x + GAP, plot.min.y)
    } else {
        Pixel::new(plot.min.x, plot.max.y + below + 5.0)
    };
    let extent = if legend.is_empty() { Vector::zeros() } else { legend.size(arrangement) };
    let bottom = (plot.max.y + below).max(corner.y + extent.y);
    let size = Vector::new((corner.x + extent.x - GAP).max(room) + 2.0 * GAP, bottom + 0.75 * GAP);
    let mut text = Group::new().add(heading).add(legend.draw(corner, arrangement));
    if picture.to_scale {
        text = text.add(scale_bar(&frame));
    }
    if let Some(film) = film {
        text = text.add(pace(&frame, film));
    }
    let bounds = Aabb { min: Pixel::origin(), max: Pixel::origin() + size };
    let document = Document::new()
        .set("viewBox", format!("0 0 {} {}", number(size.x), number(size.y)))
        .set("width", number(size.x))
        .set("height", number(size.y))
        .set("font-family", FONTS)
        .add(clip(&plot))
        .add(rectangle(bounds, PAGE).set("rx", "8"))
        .add(plotted(picture, &frame, film))
        .add(text.add(names::beside_marks(picture, &frame, film)));
    format!("{document}\n")
}

fn clip(plot: &Aabb) -> Definitions {
    let outline = rectangle(plot.inflated(0.5 * GAP), PAGE);
    Definitions::new().add(ClipPath::new().set("id", CLIP).add(outline))
}

/// Drawing order from the bottom.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Layer {
    Areas,
    Points,
    Lines,
    FloorMarks,
    Robots,
    Marks,
}

impl Layer {
    fn of(item: &Item) -> Self {
        match &item.figure {
            // A circle without a filling may surround an object, so it lies above the objects.
            Figure::Disc { .. } if item.style.fill == 0.0 => Layer::Lines,
            Figure::Disc { .. } | Figure::Polygon(_) => Layer::Areas,
            Figure::Points(_) => Layer::Points,
            Figure::Line { .. } | Figure::Moving(_) => Layer::Lines,
            Figure::Robot { .. } => Layer::Robots,
            Figure::Mark { mark, .. } if mark.is_some_and(Mark::is_on_floor) => Layer::FloorMarks,
            Figure::Mark { .. } => Layer::Marks,
        }
    }
}

/// Everything drawn to scale, from the floor up.
fn plotted(picture: &Picture, frame: &Frame, film: Option<&Film>) -> Group {
    let top = picture.top_speed();
    let layer = |layer: Layer| {
        let items = picture.items.iter().enumerate().filter(|(_, item)| Layer::of(item) == layer);
        items.fold(Group::new(), |group, (index, item)| {
            let drawn = draw(picture, item, frame, film, (top, index));
            group.add(film.map_or(drawn.clone(), |film| film.seen(drawn, item.from, item.until)))
        })
    };
    let above = [Layer::Points, Layer::Lines, Layer::FloorMarks, Layer::Robots, Layer::Marks];
    let floor = scenery::floor(&picture.world, frame, picture.to_scale);
    let floor = picture
        .grounds
        .iter()
        .fold(floor, |floor, (ground, shift)| floor.add(scenery::ground(ground, &frame.shifted(*shift))));
    let group = Group::new()
        .set("clip-path", format!("url(#{CLIP})"))
        .add(floor)
        .add(layer(Layer::Areas))
        .add(scenery::solids(&picture.world, frame));
    above.into_iter().fold(group, |group, above| group.add(layer(above)))
}

/// One item. `top` is the highest speed of the picture; the item's number names its mask.
fn draw(
    picture: &Picture,
    item: &Item,
    frame: &Frame,
    film: Option<&Film>,
    (top, index): (f64, usize),
) -> Group {
    let style = &item.style;
    let pixels = |points: &[Point]| points.iter().map(|p| frame.at(*p)).collect::<Vec<_>>();
    match &item.figure {
        Figure::Disc { centre, radius } if is_finite(centre) && radius.is_finite() => {
            lines::circle(frame.at(*centre), frame.length(radius.abs()), style)
        }
        Figure::Polygon(corners) if !corners.is_empty() => lines::outlined(&pixels(corners), style),
        Figure::Points(points) => lines::cloud(points, style, frame),
        Figure::Line { points, times, speeds } => {
            let path = Path { points, times, speeds, style };
            match film {
                Some(film) if !times.is_empty() => path.grow(frame, top, film, &format!("grown{index}")),
                _ => path.draw(frame, top),
            }
        }
        Figure::Moving(shapes) => {
            let shapes: Vec<_> = shapes.iter().map(|(time, points)| (*time, pixels(points))).collect();
            lines::moving(&shapes, style, film)
        }
        Figure::Robot { poses, footprint } => robots::robot(poses, footprint, style, frame, film),
        Figure::Mark { mark: Some(mark), position, .. } if is_finite(position) => {
            mark.symbol(frame.at(*position), around(picture, *position, frame))
        }
        _ => Group::new(),
    }
}

/// Radius in pixels of a ring around a robot that ends near a place; 0 without one.
fn around(picture: &Picture, place: Point, frame: &Frame) -> f64 {
    let near = picture.items.iter().filter_map(|item| match &item.figure {
        // Pale robots show former or future poses.
        Figure::Robot { poses, footprint } if item.style.opacity >= 1.0 => {
            let (_, pose) = poses.last()?;
            let (off, reach) = (pose.distance_to(place), footprint.bounding_radius());
            (off < 0.5 * reach).then(|| frame.length(reach + off) + 5.0)
        }
        _ => None,
    });
    near.fold(0.0, f64::max)
}

#[cfg(all(test, feature = "png"))]
mod tests {
    use proptest::prelude::*;
    use resvg::usvg;

    use super::*;
    use crate::geometry::{Point, Pose};
    use crate::picture::{Mark, Style};
    use crate::world::{Colour, Footprint, Wall, World};

    fn any_number() -> impl Strategy<Value = f64> {
        prop_oneof![8 => -5.0..5.0f64, 1 => any::<f64>()]
    }

    fn any_point() -> impl Strategy<Value = Point> {
        (any_number(), any_number()).prop_map(|(x, y)| Point::new(x, y))
    }

    fn any_picture() -> impl Strategy<Value = Picture> {
        let world = (0.0..300.0f64, 0.0..300.0f64, prop::collection::vec((any_point(), any_point()), 0..4));
        let points = prop::collection::vec(any_point(), 0..12);
        (world, points, any::<String>(), any_number()).prop_map(
            |((width, height, walls), points, text, size)| {
                let mut world = World::walled(width, height);
                world
                    .walls
                    .extend(walls.into_iter().map(|(a, b)| Wall { thickness: size, ..Wall::new(a, b) }));
                let mut picture = Picture::new(&world);
                picture.title(text.clone()).caption(text.clone()).true_path(points.clone());
                picture.speed_path(points.iter().map(|p| (*p, p.x)));
                picture.points(points.clone(), Style::lidar().width(size).opacity(size));
                for point in points {
                    picture.mark_named(Mark::Goal, point, text.clone());
                    picture.disc(point, size, Style::new(Colour::RED).filled(size).labelled(text.clone()));
                    picture.robot(Pose::new(point.x, point.y, size), &Footprint::Disc { radius: 0.1 });
                    picture.during(point.y..size);
                    let poses = [(point.x, Pose::default()), (size, Pose::new(point.x, point.y, size))];
                    picture.drive(&poses, &Footprint::Disc { radius: size });
                    picture.moving_line(
                        poses.map(|(time, pose)| (time, vec![pose.position(); 2])),
                        Style::aid(),
                    );
                    picture.trace([(size, point), (point.x, point), (point.y, point)], Style::plan());
                }
                picture
            },
        )
    }

    proptest! {
        #![proptest_config(crate::testing::cases(64))]
        #[test]
        fn whatever_is_drawn_the_document_is_well_formed(picture in any_picture()) {
            let text = picture.to_svg();
            prop_assert!(usvg::Tree::from_str(&text, &usvg::Options::default()).is_ok(), "{text}");
            prop_assert!(!text.contains("NaN\"") && !text.contains("inf\""));
            prop_assert_eq!(text, picture.to_svg());
            let moving = picture.to_moving_svg();
            prop_assert!(usvg::Tree::from_str(&moving, &usvg::Options::default()).is_ok(), "{moving}");
            prop_assert!(!["NaN", "inf;", "inf\""].iter().any(|wrong| moving.contains(wrong)), "{moving}");
        }
    }
}
