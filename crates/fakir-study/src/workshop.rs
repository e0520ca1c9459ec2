//! Surfaces with rounded pillar tops for manufacturing: a solid in STL, and a height map.
//!
//! A pillar is the part above the floor of the paraboloid of its top, inside its diameter, if defined.

use fakir::problem::{Asperity, AsperityArray, Grid, Point};
use fakir_case::height_map::to_npy;
use fakir_figure::grey_map;
use std::f64::consts::TAU;

/// Numbers of rings and sectors of a pillar in STL.
const RINGS: usize = 24;
const SECTORS: usize = 72;

/// Largest number of pixels of a map along its longer side, and number of pixels across a pillar.
const MOST_PIXELS: usize = 1024;
const PIXELS_PER_PILLAR: f64 = 32.0;

/// Largest pixel value.
const WHITE: f64 = u16::MAX as f64;

/// A pillar to be manufactured, m.
#[derive(Debug, Clone, Copy)]
struct Pillar {
    centre: Point,
    height: f64,
    top_radius: f64,
    /// Radius at which it meets the floor, or that of its wall.
    reach: f64,
}

impl Pillar {
    fn new(asperity: &Asperity, common: f64) -> Self {
        let height = common + asperity.raised;
        let foot = (2.0 * asperity.top_radius * height.max(0.0)).sqrt();
        Self {
            centre: asperity.apex,
            height,
            top_radius: asperity.top_radius,
            reach: asperity.rim_radius.map_or(foot, |rim| rim.min(foot)),
        }
    }

    /// Height above the floor at a distance from the centre.
    fn at(&self, distance: f64) -> f64 {
        (self.height - 0.5 * distance * distance / self.top_radius).max(0.0)
    }
}

/// A surface with rounded pillar tops.
#[derive(Debug, Clone)]
pub struct Relief {
    pillars: Vec<Pillar>,
    /// Lower left and upper right corner, m.
    corners: [Point; 2],
}

/// A height map.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightPicture {
    /// Its pixels as a grid, with the lens axis at the origin.
    pub grid: Grid,
    /// Heights above the floor, row by row from the lowest y, m.
    pub heights: Vec<f64>,
    /// The height that corresponds to white, m; black is the floor.
    pub white: f64,
}

impl Relief {
    /// The surface of asperities on pillars of a common height (m).
    #[must_use]
    pub fn new(field: &AsperityArray, common: f64) -> Self {
        let pillars: Vec<Pillar> = field
            .asperities()
            .iter()
            .map(|asperity| Pillar::new(asperity, common))
            .collect();
        let margin = pillars
            .iter()
            .map(|pillar| 1.25 * pillar.reach)
            .fold(0.0, f64::max);
        let end = |axis: usize, sign: f64| {
            let places = pillars.iter().map(|pillar| sign * pillar.centre[axis]);
            sign * (places.fold(f64::NEG_INFINITY, f64::max) + margin)
        };
        let corners = [[end(0, -1.0), end(1, -1.0)], [end(0, 1.0), end(1, 1.0)]];
        Self { pillars, corners }
    }

    /// The surface as a binary STL file in mm: a base as thick as the highest pillar, with its upper side at zero, and every pillar as a
    /// closed shell on it. Points of the shells are on the surface.
    #[must_use]
    pub fn stl(&self) -> Vec<u8> {
        let mut triangles: Vec<[[f64; 3]; 3]> = Vec::new();
        let thickness = self.highest();
        self.push_base(thickness, &mut triangles);
        for pillar in &self.pillars {
            // Slightly into the base, so that the two are one solid.
            pillar.push_shell(0.05 * thickness, &mut triangles);
        }
        let mut bytes = vec![0; 80];
        let title = b"fakir: pillars with rounded tops, lengths in mm";
        bytes[..title.len()].copy_from_slice(title);
        bytes.extend((triangles.len() as u32).to_le_bytes());
        for corners in &triangles {
            let numbers = normal(corners).into_iter();
            let lengths = corners.iter().flatten().map(|length| 1e3 * length);
            for number in numbers.chain(lengths) {
                bytes.extend((number as f32).to_le_bytes());
            }
            bytes.extend([0, 0]);
        }
        bytes
    }

    fn highest(&self) -> f64 {
        let heights = self.pillars.iter().map(|pillar| pillar.height);
        heights.fold(f64::MIN_POSITIVE, f64::max)
    }

    fn push_base(&self, thickness: f64, triangles: &mut Vec<[[f64; 3]; 3]>) {
        let [[left, low], [right, high]] = self.corners;
        let corner = |k: usize, z: f64| {
            let [x, y] = [[left, low], [right, low], [right, high], [left, high]][k % 4];
            [x, y, z]
        };
        let bottom = -thickness;
        for k in 0..4 {
            let [a, b] = [corner(k, bottom), corner(k + 1, bottom)];
            let [c, d] = [corner(k + 1, 0.0), corner(k, 0.0)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
        for [a, b] in [[1, 2], [2, 3]] {
            triangles.push([corner(0, 0.0), corner(a, 0.0), corner(b, 0.0)]);
            triangles.push([corner(0, bottom), corner(b, bottom), corner(a, bottom)]);
        }
    }

    /// Heights on square pixels.
    #[must_use]
    pub fn picture(&self) -> Option<HeightPicture> {
        let [[left, low], [right, high]] = self.corners;
        let sides = [right - left, high - low];
        let narrowest = self.pillars.iter().map(|pillar| pillar.reach);
        let narrowest = narrowest.fold(f64::INFINITY, f64::min);
        let wanted = 2.0 * narrowest / PIXELS_PER_PILLAR;
        let cell = wanted.max(sides[0].max(sides[1]) / MOST_PIXELS as f64);
        let [columns, rows] = sides.map(|side| ((side / cell).ceil() as usize).max(1));
        let grid = Grid::new(columns, rows, [cell; 2], [left, low]).ok()?;
        let mut heights: Vec<f64> = vec![0.0; columns * rows];
        for pillar in &self.pillars {
            let span = |axis: usize, count: usize| {
                let from = pillar.centre[axis] - self.corners[0][axis];
                let first = ((from - pillar.reach) / cell).floor().max(0.0) as usize;
                let end = ((from + pillar.reach) / cell).ceil().max(0.0) as usize + 1;
                first.min(count)..end.min(count)
            };
            for row in span(1, rows) {
                for column in span(0, columns) {
                    let x = left + cell * (column as f64 + 0.5) - pillar.centre[0];
                    let y = low + cell * (row as f64 + 0.5) - pillar.centre[1];
                    let distance = x.hypot(y);
                    if distance <= pillar.reach {
                        let height = &mut heights[row * columns + column];
                        *height = height.max(pillar.at(distance));
                    }
                }
            }
        }
        Some(HeightPicture {
            grid,
            heights,
            white: self.highest(),
        })
    }
}

impl HeightPicture {
    /// As a grey image of 16 bits (PNG), y upwards: black is the floor, white the [highest](Self::white) pillar. The file contains the size
    /// of the pixels.
    #[must_use]
    pub fn png(&self) -> Vec<u8> {
        let columns = self.grid.columns();
        let from_top = self.heights.chunks(columns).rev().flatten();
        let greys: Vec<u16> = from_top
            .map(|height| (WHITE * height / self.white).round().clamp(0.0, WHITE) as u16)
            .collect();
        grey_map([columns, self.grid.rows()], &greys, self.grid.cell()[0])
    }

    /// As a `.npy` file, which a case can read as `surface.height_map`.
    #[must_use]
    pub fn npy(&self) -> Vec<u8> {
        to_npy(&self.grid, &self.heights)
    }
}

impl Pillar {
    /// Adds its top, wall and bottom, `depth` below the floor.
    fn push_shell(&self, depth: f64, triangles: &mut Vec<[[f64; 3]; 3]>) {
        let point = |distance: f64, sector: usize, z: f64| {
            let (sin, cos) = (TAU * (sector % SECTORS) as f64 / SECTORS as f64).sin_cos();
            [
                self.centre[0] + distance * cos,
                self.centre[1] + distance * sin,
                z,
            ]
        };
        let top = [self.centre[0], self.centre[1], self.height];
        let bottom = [self.centre[0], self.centre[1], -depth];
        let ring = |k: usize| self.reach * k as f64 / RINGS as f64;
        for sector in 0..SECTORS {
            let next = sector + 1;
            for k in 0..RINGS {
                let [inner, outer] = [ring(k), ring(k + 1)];
                let [low, high] = [self.at(inner), self.at(outer)];
                let [a, b] = [point(outer, sector, high), point(outer, next, high)];
                if k == 0 {
                    triangles.push([top, a, b]);
                } else {
                    let [c, d] = [point(inner, sector, low), point(inner, next, low)];
                    triangles.extend([[c, a, b], [c, b, d]]);
                }
            }
            let edge = self.at(self.reach);
            let [a, b] = [
                point(self.reach, sector, edge),
                point(self.reach, next, edge),
            ];
            let [c, d] = [
                point(self.reach, sector, -depth),
                point(self.reach, next, -depth),
            ];
            triangles.extend([[a, c, d], [a, d, b], [bottom, d, c]]);
        }
    }
}

/// The unit normal of a triangle; zero for one without area.
fn normal([a, b, c]: &[[f64; 3]; 3]) -> [f64; 3] {
    let side = |end: &[f64; 3]| [0, 1, 2].map(|k| end[k] - a[k]);
    let (u, v) = (side(b), side(c));
    let cross = [
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    ];
    let length = cross.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 {
        cross.map(|x| x / length)
    } else {
        [0.0; 3]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fakir::problem::{Indenter, Material};
    use std::f64::consts::PI;

    fn relief(rim: Option<f64>) -> Relief {
        let asperities = [[-1e-4, 0.0], [1e-4, 0.0]].map(|apex| Asperity {
            rim_radius: rim,
            ..Asperity::new(apex, 1e-4)
        });
        let field = AsperityArray::new(
            Indenter::Flat(None),
            Material::new(1e6, 0.5),
            asperities.to_vec(),
        );
        Relief::new(&field.unwrap(), 1e-5)
    }

    /// Volume inside closed shells, by the divergence theorem.
    fn volume(stl: &[u8]) -> f64 {
        let number = |at: usize| f64::from(f32::from_le_bytes(stl[at..at + 4].try_into().unwrap()));
        let count = u32::from_le_bytes(stl[80..84].try_into().unwrap()) as usize;
        assert_eq!(stl.len(), 84 + 50 * count);
        let solid = |k: usize| {
            let corner = |m: usize| [0, 1, 2].map(|n| number(84 + 50 * k + 12 + 12 * m + 4 * n));
            let [a, b, c] = [corner(0), corner(1), corner(2)];
            (a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0]))
                / 6.0
        };
        (0..count).map(solid).sum()
    }

    /// Paraboloids fill half of the surrounding cylinder; sectors reduce the circle by `1 - sin(x)/x`, for 72 of them by 0.13 %.
    #[test]
    fn the_solid_has_the_volume_of_base_and_pillars() {
        let height = 1e-2; // mm
        let foot = f64::sqrt(2.0 * 0.1 * height);
        for (rim, above) in [
            (None, 0.5 * height),
            (Some(2e-5), height - 0.25 * 4e-4 / 0.1),
        ] {
            let relief = relief(rim);
            let [[left, low], [right, high]] = relief.corners;
            let base = 1e6 * (right - left) * (high - low) * height;
            let radius = rim.map_or(foot, |rim| 1e3 * rim);
            let pillars = 2.0 * PI * radius * radius * (above + 0.05 * height);
            let found = volume(&relief.stl());
            assert!(
                ((found - base) / pillars - 1.0).abs() < 3e-3,
                "{found} {base} {pillars}"
            );
        }
    }

    #[test]
    fn pixels_have_the_heights() {
        let picture = relief(None).picture().unwrap();
        let [columns, rows] = [picture.grid.columns(), picture.grid.rows()];
        assert_eq!(picture.heights.len(), columns * rows);
        let highest = picture.heights.iter().copied().fold(0.0, f64::max);
        // At most half a pixel from the centre.
        let cell = picture.grid.cell()[0];
        assert!(highest <= 1e-5 && highest > 1e-5 - 0.25 * cell * cell / 1e-4);
        let volume: f64 = picture.heights.iter().sum::<f64>() * cell * cell;
        let paraboloids = 2.0 * 0.5 * PI * (2.0 * 1e-4 * 1e-5) * 1e-5;
        assert!((volume / paraboloids - 1.0).abs() < 0.01, "{volume}");
        assert!(picture.png().starts_with(b"\x89PNG"));
    }
}
