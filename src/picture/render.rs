//! Puts the parts of a picture on a page.

use svg::Document;
use svg::node::element::{ClipPath, Definitions, Group};

use super::canvas::{FONTS, number, rectangle};
use super::colours::PAGE;
use super::decorations::{SCALE_HEIGHT, heading, heading_height, heading_width, scale_bar};
use super::frame::{Frame, Pixel};
use super::items::Picture;
use super::legend::{Arrangement, Legend};
use super::{lines, names, robots, scenery};
use crate::geometry::{Aabb, Vector};

/// Pixels round the plot.
const MARGIN: f64 = 28.0;
/// Pixels between plot and legend.
const GUTTER: f64 = 26.0;
/// Pixels of the page's width at least, for titles.
const NARROWEST_PAGE: f64 = 340.0;
/// Pixels of the page's width at most.
const WIDEST_PAGE: f64 = 1340.0;
/// Pixels around the world where paths still show.
const BLEED: f64 = 10.0;
/// The name of the outline beyond which nothing is drawn.
const CLIP: &str = "frame";

impl Picture {
    /// The picture as an SVG document.
    pub fn to_svg(&self) -> String {
        let top = MARGIN + heading_height(self);
        let frame = Frame::around(self.region(), Pixel::new(MARGIN, top));
        let legend = Legend::of(self);
        let plot = frame.pixels();
        let below = if self.to_scale { SCALE_HEIGHT } else { 0.0 };
        let (arrangement, corner) = arrange(&plot, below);
        let extent = if legend.is_empty() { Vector::zeros() } else { legend.size(arrangement) };
        let bottom = (plot.max.y + below).max(corner.y + extent.y);
        let wanted = (corner.x + extent.x).max(plot.max.x).max(MARGIN + heading_width(self)) + MARGIN;
        let page = Vector::new(wanted.clamp(NARROWEST_PAGE, WIDEST_PAGE), bottom + 0.75 * MARGIN);

        let text = Group::new()
            .add(heading(self, Pixel::new(MARGIN, MARGIN), page.x - 2.0 * MARGIN))
            .add(if self.to_scale { scale_bar(&frame) } else { Group::new() })
            .add(legend.draw(corner, arrangement))
            .add(names::beside_marks(self, &frame));
        let page_bounds = Aabb { min: Pixel::origin(), max: Pixel::origin() + page };
        let document = Document::new()
            .set("viewBox", format!("0 0 {} {}", number(page.x), number(page.y)))
            .set("width", number(page.x))
            .set("height", number(page.y))
            .set("font-family", FONTS)
            .add(clip(&plot))
            .add(rectangle(page_bounds, PAGE))
            .add(plotted(self, &frame))
            .add(text);
        format!("{document}\n")
    }
}

/// Where the legend goes: beside the plot, or below it and so many pixels if the plot is wide.
fn arrange(plot: &Aabb, below: f64) -> (Arrangement, Pixel) {
    let size = plot.size();
    if size.x > 1.7 * size.y {
        let room = size.x.max(NARROWEST_PAGE);
        (Arrangement::Rows(room), Pixel::new(plot.min.x, plot.max.y + below + 8.0))
    } else {
        (Arrangement::Column, Pixel::new(plot.max.x + GUTTER, plot.min.y - 2.0))
    }
}

fn clip(plot: &Aabb) -> Definitions {
    let outline = rectangle(plot.inflated(BLEED), PAGE);
    Definitions::new().add(ClipPath::new().set("id", CLIP).add(outline))
}

/// Everything that is drawn to scale, from the floor up.
fn plotted(picture: &Picture, frame: &Frame) -> Group {
    let areas = picture.areas.iter().fold(Group::new(), |group, a| group.add(lines::area(a, frame)));
    let clouds = picture.clouds.iter().fold(Group::new(), |group, c| group.add(lines::cloud(c, frame)));
    let top = lines::top_speed(picture);
    let paths = picture.lines.iter().fold(Group::new(), |group, l| group.add(lines::path(l, frame, top)));
    let robots = picture.robots.iter().fold(Group::new(), |group, r| group.add(robots::outline(r, frame)));
    let marks = picture
        .finite_marks()
        .filter_map(|marked| Some(marked.mark?.symbol(frame.at(marked.position))))
        .fold(Group::new(), Group::add);
    Group::new()
        .set("clip-path", format!("url(#{CLIP})"))
        .add(scenery::floor(&picture.world, frame, picture.to_scale))
        .add(areas)
        .add(scenery::solids(&picture.world, frame))
        .add(clouds)
        .add(paths)
        .add(robots)
        .add(marks)
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
        }
    }
}
