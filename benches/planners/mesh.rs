//! A mesh of rectangles for polyanya: stretches of free cells in rows, joined where they are the same from
//! row to row.

use glam::Vec2;
use polyanya::{Mesh, Polygon, Vertex};
use roverlab::world::{BitGrid, GridCell};

/// A rectangle of free cells: columns and rows, the ends not included.
struct Rectangle {
    columns: (usize, usize),
    rows: (usize, usize),
}

const OUTSIDE: u32 = u32::MAX;

/// The mesh. Rows count upwards in it, as its polygons must turn counter-clockwise.
pub(crate) fn of_rectangles(grid: &BitGrid) -> Mesh {
    let (width, height) = (grid.width(), grid.height());
    let rectangles = rectangles(grid);
    let mut of_cell = vec![OUTSIDE; width * height];
    let mut is_corner = vec![false; (width + 1) * (height + 1)];
    for (number, Rectangle { columns, rows }) in rectangles.iter().enumerate() {
        for row in rows.0..rows.1 {
            of_cell[row * width + columns.0..row * width + columns.1].fill(number as u32);
        }
        for y in [rows.0, rows.1] {
            is_corner[y * (width + 1) + columns.0] = true;
            is_corner[y * (width + 1) + columns.1] = true;
        }
    }
    let mut numbers = vec![OUTSIDE; is_corner.len()];
    let mut vertices = Vec::new();
    for (point, _) in is_corner.iter().enumerate().filter(|(_, is)| **is) {
        let (x, y) = (point % (width + 1), point / (width + 1));
        let at = |dx: usize, dy: usize| match ((x + dx).checked_sub(1), (y + dy).checked_sub(1)) {
            (Some(column), Some(row)) if column < width && row < height => of_cell[row * width + column],
            _ => OUTSIDE,
        };
        // Counter-clockwise with rows counted upwards: right above, left above, left below, right below.
        let mut around = vec![at(1, 0), at(0, 0), at(0, 1), at(1, 1)];
        around.dedup();
        if around.len() > 1 && around.first() == around.last() {
            around.pop();
        }
        numbers[point] = vertices.len() as u32;
        vertices.push(Vertex::new(Vec2::new(x as f32, (height - y) as f32), around));
    }
    let number = |x: usize, y: usize| Some(numbers[y * (width + 1) + x]).filter(|&number| number != OUTSIDE);
    let polygon = |Rectangle { columns, rows }: &Rectangle| {
        let bottom = (columns.0..columns.1).filter_map(|x| number(x, rows.1));
        let right = (rows.0 + 1..=rows.1).rev().filter_map(|y| number(columns.1, y));
        let top = (columns.0 + 1..=columns.1).rev().filter_map(|x| number(x, rows.0));
        let left = (rows.0..rows.1).filter_map(|y| number(columns.0, y));
        Polygon::new(bottom.chain(right).chain(top).chain(left).collect(), false)
    };
    let polygons = rectangles.iter().map(polygon).collect();
    let mut mesh = Mesh::new(vertices, polygons).expect("a mesh");
    mesh.bake();
    mesh
}

fn rectangles(grid: &BitGrid) -> Vec<Rectangle> {
    let mut done = Vec::new();
    let mut open: Vec<Rectangle> = Vec::new();
    for row in 0..=grid.height() {
        let stretches = stretches(grid, row);
        let mut next = Vec::new();
        for columns in stretches {
            let above = open.iter().position(|rectangle| rectangle.columns == columns);
            let rows = above.map_or((row, row + 1), |index| (open.swap_remove(index).rows.0, row + 1));
            next.push(Rectangle { columns, rows });
        }
        done.append(&mut open);
        open = next;
    }
    done.append(&mut open);
    done
}

fn stretches(grid: &BitGrid, row: usize) -> Vec<(usize, usize)> {
    let mut found: Vec<(usize, usize)> = Vec::new();
    for column in (0..grid.width()).filter(|&column| grid.is_free(GridCell::new(column, row))) {
        match found.last_mut() {
            Some(last) if last.1 == column => last.1 += 1,
            _ => found.push((column, column + 1)),
        }
    }
    found
}
