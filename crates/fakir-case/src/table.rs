//! The key table: the only definition of every key of a case file.
//!
//! It controls reading and writing of files, overrides, requests and error messages, and the
//! [reference](crate::reference) is generated from it. To add a key, add a row.

use crate::parts::{BaseForm, Choice, Parts};
use crate::unit::{Dimension, format_quantity};
use fakir::problem::pattern::{PatternQuantity, PatternQuantity as Q};
use fakir::problem::{LARGEST_TILT, LensForm, MAXIMUM_SURFACE_FRACTION, Quantity, Requirement};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_6};
use std::fmt;
use std::ops::Bound::{self, Excluded, Included, Unbounded};

/// Defines the enum of keys, their list, and their rows.
macro_rules! keys {
    ($($part:ident { $($key:ident = $path:literal is $row:expr;)+ })+) => {
        /// A key of a case file.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
        pub enum Key {
            $($(#[doc = concat!("`", $path, "`")] $key,)+)+
        }

        const COUNT: usize = [$($($path),+),+].len();

        impl Key {
            /// Every key, in the order in which files are written.
            pub const ALL: [Self; COUNT] = [$($(Self::$key),+),+];
        }

        /// Part, path and row of each key, in the order of [`Key::ALL`].
        pub(crate) static TABLE: [(Part, &str, Row); COUNT] =
            [$($((Part::$part, $path, $row)),+),+];
    };
}

/// Part of a case to which a key belongs. No case has all parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    /// The two bodies, which every case has.
    Bodies,
    /// The shape of the lens, of pillars with flat or rounded tops and of flat surfaces.
    Shape,
    /// Adhesion, of every surface.
    Adhesion,
    /// That of the floor, of every surface but a flat one.
    AdhesionOnFloor,
    /// Interactions that do not change the normal contact, of every surface.
    Interactions,
    /// Those on the floor, of every surface but a flat one.
    InteractionsOnFloor,
    /// Whether the floor carries load, of every surface but a flat one.
    FloorLoad,
    /// A pattern of round pillars, and its method.
    PillarPattern,
    /// A surface without pillars.
    Flat,
    /// A general surface read from a file.
    HeightMap,
    /// A general surface with pillars of any shape.
    Pattern,
    /// Any general surface.
    Surface,
}

impl Part {
    /// The parts of pillars with flat or rounded tops.
    pub(crate) const OF_PILLARS: &[Self] = &[
        Self::Bodies,
        Self::Shape,
        Self::Adhesion,
        Self::AdhesionOnFloor,
        Self::PillarPattern,
        Self::FloorLoad,
        Self::Interactions,
        Self::InteractionsOnFloor,
    ];

    /// Those of a flat surface.
    pub(crate) const OF_FLAT: &[Self] = &[
        Self::Bodies,
        Self::Shape,
        Self::Adhesion,
        Self::Flat,
        Self::Interactions,
    ];
}

const FRACTION: Range = Range::Between(Included(0.0), Excluded(1.0));
const POISSON: Range = Range::Between(Included(0.0), Included(0.5));
/// The shapes of a lens that have a radius.
const ROUND_LENSES: &[&str] = &["sphere", "paraboloid", "cylinder", "punch"];
/// Arrangements of a pillar pattern that are lattices, and those with a surface fraction.
const PLANE_LATTICES: &[&str] = &["hexagonal", "square", "rectangular", "oblique"];
const EVEN_LATTICES: &[&str] = &["hexagonal", "square"];
/// Arrangements that are lattices, without random pillars.
const LATTICES: &[&str] = &["hexagonal", "square"];

#[rustfmt::skip]
keys! {
    Bodies {
        LensRadius = "lens.radius" is
            length("radius of curvature; of a punch its radius", |p| &mut p.lens.radius)
                .symbol("R").usual(1e-5, 1e-1)
                .positive().with(Key::Indenter, &["lens"]).also_with(Key::LensShape, ROUND_LENSES).of(Quantity::LensRadius);
        LensYoungModulus = "lens.young_modulus" is
            pressure("Young's modulus", |p| &mut p.lens.material.young_modulus)
                .label("Young's modulus").symbol("E_l").usual(1e3, 1e11)
                .positive().of(Quantity::LensYoungModulus);
        LensPoissonRatio = "lens.poisson_ratio" is
            number("Poisson's ratio, 0 to 0.5", |p| &mut p.lens.material.poisson_ratio)
                .label("Poisson's ratio").symbol("ν_l")
                .range(POISSON).of(Quantity::LensPoissonRatio);
    }
    Shape {
        LensShape = "lens.shape" is
            word("shape of the lens; under a cylinder or a plate there are finitely many pillars", |p| &mut p.shape.form)
                .optional().with(Key::Indenter, &["lens"])
                .unwritten(|p| p.shape.form == LensForm::Sphere);
        LensAngle = "lens.angle" is
            angle("direction of the lowest line of a cylinder, relative to x", |p| &mut p.shape.angle)
                .optional().with(Key::LensShape, &["cylinder"]).of(Quantity::LensAngle);
        LensTilt = "lens.tilt" is
            angle("angle between a plate and the floor", |p| &mut p.shape.tilt)
                .range(Range::Between(Included(0.0), Included(LARGEST_TILT))).optional().with(Key::LensShape, &["plate"])
                .of(Quantity::LensTilt);
        LensTiltDirection = "lens.tilt_direction" is
            angle("direction in which a plate rises, relative to x", |p| &mut p.shape.tilt_direction)
                .optional().with(Key::LensShape, &["plate"]).of(Quantity::LensTiltDirection);
        LensProfile = "lens.profile" is
            text("table of the heights of a lens: columns radius_m, height_m", |p| &mut p.shape.profile)
                .with(Key::LensShape, &["profile"])
                .unwritten(|p| p.shape.profile.is_empty());
    }
    Bodies {
        LensThickness = "lens.thickness" is
            length("thickness of a flat layer; indentations are then the approach of the backs", |p| &mut p.lens_layer.thickness)
                .label("thickness of the lens").symbol("t").usual(1e-5, 1e-2)
                .positive().otherwise("it is a half-space").of(Quantity::LensThickness)
                .unwritten(|p| p.lens_layer.thickness.is_nan());
        LensBase = "lens.base" is
            word("base to which its back is bonded: rigid or elastic; or frictionless: a rigid base on which it can slide", |p| &mut p.lens_layer.base)
                .label("base of the lens").optional().needs(Key::LensThickness)
                .unwritten(|p| p.lens_layer.base == BaseForm::Rigid);
        LensBaseYoungModulus = "lens.base_young_modulus" is
            pressure("Young's modulus of an elastic base", |p| &mut p.lens_layer.material.young_modulus)
                .label("Young's modulus of the base").positive().with(Key::LensBase, &["elastic"]).of(Quantity::LensBaseYoungModulus);
        LensBasePoissonRatio = "lens.base_poisson_ratio" is
            number("Poisson's ratio of an elastic base, 0 to 0.5", |p| &mut p.lens_layer.material.poisson_ratio)
                .label("Poisson's ratio of the base").range(POISSON).with(Key::LensBase, &["elastic"]).of(Quantity::LensBasePoissonRatio);
        SubstrateYoungModulus = "substrate.young_modulus" is
            pressure("Young's modulus, also of the pillars", |p| &mut p.substrate.young_modulus)
                .label("Young's modulus").symbol("E_s").usual(1e3, 1e11)
                .positive().of(Quantity::SubstrateYoungModulus).of_pattern(Q::YoungModulus);
        SubstratePoissonRatio = "substrate.poisson_ratio" is
            number("Poisson's ratio, 0 to 0.5", |p| &mut p.substrate.poisson_ratio)
                .label("Poisson's ratio").symbol("ν_s")
                .range(POISSON).of(Quantity::SubstratePoissonRatio);
        SubstrateThickness = "substrate.thickness" is
            length("thickness of a film; indentations are then the approach of the backs", |p| &mut p.substrate_layer.thickness)
                .label("thickness of the substrate").symbol("t").usual(1e-5, 1e-2)
                .positive().otherwise("it is a half-space").of(Quantity::SubstrateThickness)
                .unwritten(|p| p.substrate_layer.thickness.is_nan());
        SubstrateBase = "substrate.base" is
            word("base to which its back is bonded: rigid or elastic; or frictionless: a rigid base on which it can slide", |p| &mut p.substrate_layer.base)
                .label("base of the substrate").optional().needs(Key::SubstrateThickness)
                .unwritten(|p| p.substrate_layer.base == BaseForm::Rigid);
        SubstrateBaseYoungModulus = "substrate.base_young_modulus" is
            pressure("Young's modulus of an elastic base", |p| &mut p.substrate_layer.material.young_modulus)
                .label("Young's modulus of the base").positive().with(Key::SubstrateBase, &["elastic"]).of(Quantity::SubstrateBaseYoungModulus);
        SubstrateBasePoissonRatio = "substrate.base_poisson_ratio" is
            number("Poisson's ratio of an elastic base, 0 to 0.5", |p| &mut p.substrate_layer.material.poisson_ratio)
                .label("Poisson's ratio of the base").range(POISSON).with(Key::SubstrateBase, &["elastic"]).of(Quantity::SubstrateBasePoissonRatio);
    }
    Bodies {
        RelaxationStrengths = "relaxation.strengths" is
            list(Dimension::Number, "viscoelastic bodies: all moduli are times 1 + sum strengths exp(-t/times), so that young_modulus is the relaxed one", |p| &mut p.relaxation.strengths)
                .otherwise("the bodies are elastic").unwritten(|p| p.relaxation.strengths.is_empty());
        RelaxationTimes = "relaxation.times" is
            list(Dimension::Time, "relaxation times, one for every strength", |p| &mut p.relaxation.times)
                .otherwise("the bodies are elastic").unwritten(|p| p.relaxation.times.is_empty());
        RelaxationTable = "relaxation.table" is
            text("table of a measured relaxation modulus, columns time_s, modulus_Pa, to which strengths and times are fitted; or give these instead", |p| &mut p.relaxation.table)
                .otherwise("strengths and times are given").unwritten(|p| p.relaxation.table.is_empty());
    }
    PillarPattern {
        Lattice = "pattern.lattice" is
            word("hexagonal, square, rectangular, oblique or listed", |p| &mut p.pattern.name)
                .optional();
        Pillars = "pattern.pillars" is
            text("table of pillars: columns x_m, y_m, and where they differ height_m, diameter_m, in any unit", |p| &mut p.pattern.pillars)
                .with(Key::Lattice, &["listed"])
                .unwritten(|p| p.pattern.pillars.is_empty());
        PillarColumns = "pattern.pillar_columns" is
            text("columns of the table by heading or number: x = POSITION_X, y = 4; also height, and diameter, radius or area", |p| &mut p.pattern.pillar_columns)
                .otherwise("their headings name them, and there are no others").with(Key::Lattice, &["listed"])
                .unwritten(|p| p.pattern.pillar_columns.is_empty());
        PillarUnit = "pattern.pillar_unit" is
            text("unit of columns without one, as um, or the size of a pixel, as 0.325 um", |p| &mut p.pattern.pillar_unit)
                .otherwise("units are in the headings").with(Key::Lattice, &["listed"])
                .unwritten(|p| p.pattern.pillar_unit.is_empty());
        AxisX = "pattern.axis_x" is
            length("position of the lens axis among listed pillars, along x", |p| &mut p.pattern.axis[0])
                .optional().with(Key::Lattice, &["listed"]);
        AxisY = "pattern.axis_y" is
            length("position of the lens axis among listed pillars, along y", |p| &mut p.pattern.axis[1])
                .optional().with(Key::Lattice, &["listed"]);
        SurfaceFraction = "pattern.surface_fraction" is
            fraction("fraction of the surface covered by pillar tops; or give pitch instead", |p| &mut p.pattern.arrangement.surface_fraction)
                .symbol("φ").usual(3e-4, 0.3)
                .range(Range::SurfaceFraction).or(Key::Pitch).with(Key::Lattice, EVEN_LATTICES).of(Quantity::SurfaceFraction);
        Pitch = "pattern.pitch" is
            length("distance between neighbouring pillars; or give surface_fraction instead", |p| &mut p.pattern.arrangement.lattice.pitch)
                .symbol("e").usual(1e-6, 1e-3)
                .range(Range::AtLeast(Key::PillarDiameter)).or(Key::SurfaceFraction).with(Key::Lattice, PLANE_LATTICES).of(Quantity::Pitch);
        PitchY = "pattern.pitch_y" is
            length("pitch along the second rows: along y of a rectangular lattice", |p| &mut p.pattern.arrangement.pitch_y)
                .usual(1e-6, 1e-3)
                .range(Range::AtLeast(Key::PillarDiameter)).with(Key::Lattice, &["rectangular", "oblique"]).of(Quantity::PitchY);
        LatticeAngle = "pattern.lattice_angle" is
            angle("angle between the rows of an oblique lattice", |p| &mut p.pattern.arrangement.lattice_angle)
                .usual(FRAC_PI_6, 5.0 * FRAC_PI_6)
                .range(Range::Words("above 0 and below 180 deg")).with(Key::Lattice, &["oblique"]).of(Quantity::LatticeAngle);
        Offset = "pattern.offset" is
            number("distance of the lens axis from a pillar centre, in pitches", |p| &mut p.pattern.arrangement.lattice.offset)
                .symbol("dx/e").usual(0.0, 1.0)
                .range(Range::Between(Included(0.0), Included(1000.0))).optional().with(Key::Lattice, PLANE_LATTICES).of(Quantity::Offset);
        OffsetAngle = "pattern.offset_angle" is
            angle("direction of the offset; x points to a second neighbour", |p| &mut p.pattern.arrangement.lattice.offset_angle)
                .usual(0.0, FRAC_PI_2)
                .optional().with(Key::Lattice, PLANE_LATTICES).of(Quantity::OffsetAngle);
        Rotation = "pattern.rotation" is
            angle("rotation of the lattice about the lens axis, anticlockwise", |p| &mut p.pattern.arrangement.rotation)
                .usual(0.0, FRAC_PI_2)
                .optional().with(Key::Lattice, PLANE_LATTICES).of(Quantity::Rotation)
                .unwritten(|p| p.pattern.arrangement.is_plain());
        Columns = "pattern.columns" is
            number("pillars along each side of a finite lattice", |p| &mut p.pattern.arrangement.columns)
                .range(Range::Whole(1, 10_000)).otherwise("the lattice has no end").with(Key::Lattice, PLANE_LATTICES)
                .unwritten(|p| p.pattern.arrangement.columns.is_nan());
        HeightStandardDeviation = "pattern.height_standard_deviation" is
            fraction("standard deviation of the normally distributed pillar heights, relative to the height", |p| &mut p.pattern.arrangement.disorder.heights.parameter)
                .formerly("pattern.height_spread").label("standard deviation of heights").usual(0.0, 0.1).range(Range::Between(Included(0.0), Included(0.2))).optional().with(Key::Lattice, PLANE_LATTICES)
                .of(Quantity::HeightSpread)
                .unwritten(|p| p.pattern.arrangement.is_plain());
        VacancyFraction = "pattern.vacancy_fraction" is
            fraction("probability that a pillar is missing", |p| &mut p.pattern.arrangement.disorder.missing)
                .formerly("pattern.missing").usual(0.0, 0.2).range(Range::Between(Included(0.0), Included(0.9))).optional().with(Key::Lattice, PLANE_LATTICES)
                .of(Quantity::Missing)
                .unwritten(|p| p.pattern.arrangement.is_plain());
        PillarSeed = "pattern.seed" is
            number("seed of random heights and missing pillars (whole number)", |p| &mut p.pattern.arrangement.seed)
                .usual(0.0, 100.0)
                .range(Range::Whole(0, 1 << f64::MANTISSA_DIGITS)).optional().with(Key::Lattice, PLANE_LATTICES)
                .unwritten(|p| p.pattern.arrangement.is_plain());
        TopRadius = "pattern.top_radius" is
            length("radius of curvature of rounded pillar tops, which then need no diameter; not supported by fakir theory and compare", |p| &mut p.pattern.top_radius)
                .label("top radius").positive().otherwise("tops are flat").of(Quantity::TopRadius)
                .unwritten(|_| true);
        PillarDiameter = "pattern.pillar.diameter" is
            length("diameter of a pillar", |p| &mut p.pattern.pillar.diameter)
                .symbol("d").usual(1e-7, 1e-4)
                .positive().of(Quantity::PillarDiameter);
        PillarHeight = "pattern.pillar.height" is
            length("height of a pillar", |p| &mut p.pattern.pillar.height)
                .symbol("h").usual(1e-8, 1e-4)
                .range(Range::Below(Key::LensRadius)).of(Quantity::PillarHeight);
        PillarCompliance = "pattern.pillar.compliance" is
            word("column: pillars shorten under load; elastic: elastic bodies; none: rigid", |p| &mut p.pattern.pillar.compliance)
                .optional();
    }
    FloorLoad {
        FloorContact = "floor.contact" is
            word("false: floor contact is ignored, as in the paper; on pillars, computed only by the method spectral", |p| &mut p.pattern.floor)
                .label("floor contact").optional();
    }
    Adhesion {
        WorkOfAdhesion = "adhesion.work" is
            energy_per_area("work of adhesion between lens and pillar tops, or a flat surface; on pillars, with the method spectral only", |p| &mut p.pattern.adhesion.work)
                .label("work of adhesion").symbol("w").usual(1e-3, 0.5)
                .range(Range::Between(Included(0.0), Unbounded)).optional().of(Quantity::WorkOfAdhesion)
                .unwritten(|p| p.pattern.adhesion.is_none());
        RecedingWorkOfAdhesion = "adhesion.work_receding" is
            energy_per_area("work of adhesion on detachment, if larger", |p| &mut p.pattern.adhesion.work_receding)
                .label("work of adhesion on unloading")
                .range(Range::AtLeast(Key::WorkOfAdhesion)).otherwise("as `work`").needs(Key::WorkOfAdhesion)
                .of(Quantity::RecedingWorkOfAdhesion)
                .unwritten(|p| !p.pattern.adhesion.recedes);
    }
    AdhesionOnFloor {
        AdhesiveFloor = "adhesion.floor" is
            word("true: the floor is adhesive too; the lens jumps onto it at first contact", |p| &mut p.pattern.adhesion.floor)
                .label("adhesive floor").optional()
                .unwritten(|p| !p.pattern.adhesion.floor.0);
    }
    Interactions {
        ShearStressTops = "friction.shear_stress_tops" is
            pressure("constant shear stress on pillar tops in contact, or in the whole contact on a surface without a floor, for the lateral force", |p| &mut p.interactions.friction.get_or_insert_default().shear_stress_tops)
                .label("shear stress on tops").symbol("τ_tops").usual(1e3, 1e8)
                .range(Range::Between(Included(0.0), Unbounded)).optional()
                .unwritten(|p| p.interactions.friction.is_none());
    }
    InteractionsOnFloor {
        ShearStressFloor = "friction.shear_stress_floor" is
            pressure("constant shear stress on the floor in contact, for the lateral force", |p| &mut p.interactions.friction.get_or_insert_default().shear_stress_floor)
                .label("shear stress on floor").symbol("τ_floor").usual(1e3, 1e8)
                .range(Range::Between(Included(0.0), Unbounded)).optional()
                .unwritten(|p| p.interactions.friction.is_none());
    }
    Flat {
        Flat = "surface.flat" is
            word("true: there are no pillars, as without [pattern] and [surface]", |p| &mut p.surface.flat)
                .optional();
    }
    HeightMap {
        HeightMap = "surface.height_map" is
            text("file of heights: .npy, .npz, numbers in text, SDF, X3P, PNG or TIFF; or give arrangement instead", |p| &mut p.surface.height_map)
                .presence(Presence::EitherSurface(Key::Arrangement));
        Array = "surface.array" is
            text("name of the array in an .npz file with several", |p| &mut p.surface.array)
                .otherwise("the file has one array");
        HeightUnit = "surface.height_unit" is
            length("unit of the heights in the file", |p| &mut p.surface.height_unit)
                .usual(1e-9, 1.0).range(Range::NotZero).optional();
        HeightRange = "surface.height_range" is
            length("of an image: height of white above black", |p| &mut p.surface.height_range)
                .usual(1e-9, 1e-3).positive().otherwise("height_unit is the height of one grey value");
        MissingPoints = "surface.missing_points" is
            word("refuse: points of the file without a height are an error; or fill: they are interpolated", |p| &mut p.surface.missing_points)
                .optional();
        CellSize = "surface.cell_size" is
            length("distance between neighbouring points of the map; or give width instead, or neither if the file contains its size", |p| &mut p.surface.cell_size)
                .positive().or(Key::MapWidth);
        MapWidth = "surface.width" is
            length("extent of the map along x; or give cell_size instead", |p| &mut p.surface.width)
                .usual(1e-7, 1e-1).positive().or(Key::CellSize);
    }
    Pattern {
        Arrangement = "surface.arrangement" is
            word("arrangement of pillars: hexagonal, square or random; or give height_map instead", |p| &mut p.surface.name)
                .presence(Presence::EitherSurface(Key::HeightMap));
        PatternFraction = "surface.surface_fraction" is
            fraction("fraction of the surface covered by pillars; or give pitch instead", |p| &mut p.surface.arrangement.surface_fraction)
                .range(Range::Between(Excluded(0.0), Excluded(1.0))).or(Key::PatternPitch).of_pattern(Q::SurfaceFraction);
        PatternPitch = "surface.pitch" is
            length("distance between neighbouring pillars; or give surface_fraction instead", |p| &mut p.surface.arrangement.lattice.pitch)
                .positive().or(Key::PatternFraction).with(Key::Arrangement, LATTICES).of_pattern(Q::Pitch);
        MinimumDistance = "surface.minimum_distance" is
            length("minimum distance between the centres of random pillars", |p| &mut p.surface.arrangement.minimum_distance)
                .range(Range::Words("at least the outer diameter of a pillar"))
                .otherwise("the outer diameter of a pillar").with(Key::Arrangement, &["random"]).of_pattern(Q::MinimumDistance);
        PatternOffset = "surface.offset" is
            number("distance of the lens axis from a pillar centre, in pitches", |p| &mut p.surface.arrangement.lattice.offset)
                .optional().with(Key::Arrangement, LATTICES).of_pattern(Q::Offset);
        PatternOffsetAngle = "surface.offset_angle" is
            angle("direction of the offset from x", |p| &mut p.surface.arrangement.lattice.offset_angle)
                .optional().with(Key::Arrangement, LATTICES).of_pattern(Q::OffsetAngle);
        SurfaceVacancyFraction = "surface.vacancy_fraction" is
            fraction("fraction of missing pillars", |p| &mut p.surface.arrangement.disorder.missing)
                .formerly("surface.missing").range(FRACTION).optional().of_pattern(Q::Missing);
        HeightHalfWidth = "surface.height_half_width" is
            fraction("half-width of the uniformly distributed pillar heights, relative to the height", |p| &mut p.surface.arrangement.disorder.heights.parameter)
                .formerly("surface.height_spread").range(FRACTION).optional().of_pattern(Q::HeightHalfWidth);
        // Integers that a number in a case file represents exactly.
        Seed = "surface.seed" is
            number("seed of random numbers (whole number)", |p| &mut p.surface.arrangement.seed)
                .range(Range::Whole(0, 1 << f64::MANTISSA_DIGITS)).optional();
    }
    Surface {
        Floor = "surface.floor" is
            length("points at or below this height are floor; default: all points outside pillars", |p| &mut p.surface.floor)
                .otherwise("all points outside pillars; none of a height map");
        Boundary = "surface.boundary" is
            word("free: no contact beyond the grid; or periodic", |p| &mut p.surface.boundary)
                .optional();
        Indenter = "surface.indenter" is
            word("lens or plate", |p| &mut p.surface.indenter)
                .optional();
    }
    Pattern {
        CrossSection = "surface.pillar.cross_section" is
            word("circle, square, polygon or ellipse", |p| &mut p.outline.form)
                .optional();
        OutlineDiameter = "surface.pillar.diameter" is
            length("diameter of a circle, or of the circumcircle of a polygon", |p| &mut p.outline.diameter)
                .positive().with(Key::CrossSection, &["circle", "polygon"]).of_pattern(Q::Diameter);
        OutlineSide = "surface.pillar.side" is
            length("side of a square", |p| &mut p.outline.side)
                .positive().with(Key::CrossSection, &["square"]).of_pattern(Q::Side);
        OutlineSides = "surface.pillar.sides" is
            number("number of sides of a polygon", |p| &mut p.outline.sides)
                .range(Range::Whole(3, 1000)).with(Key::CrossSection, &["polygon"]);
        OutlineLength = "surface.pillar.length" is
            length("length of an ellipse, along x", |p| &mut p.outline.length)
                .positive().with(Key::CrossSection, &["ellipse"]).of_pattern(Q::Length);
        OutlineWidth = "surface.pillar.width" is
            length("width of an ellipse, along y", |p| &mut p.outline.width)
                .positive().with(Key::CrossSection, &["ellipse"]).of_pattern(Q::Width);
        Orientation = "surface.pillar.orientation" is
            angle("rotation of pillars, anticlockwise", |p| &mut p.outline.orientation)
                .optional().of_pattern(Q::Orientation);
        PatternHeight = "surface.pillar.height" is
            length("height of a pillar", |p| &mut p.outline.height)
                .positive().of_pattern(Q::Height);
        Top = "surface.pillar.top" is
            word("flat, cone, chamfer or rounded", |p| &mut p.outline.top)
                .optional();
        Drop = "surface.pillar.drop" is
            length("height difference between centre and edge of a cone or chamfer", |p| &mut p.outline.drop)
                .range(Range::UpTo(Key::PatternHeight)).with(Key::Top, &["cone", "chamfer"]).of_pattern(Q::Drop);
        ChamferWidth = "surface.pillar.chamfer_width" is
            length("width of a chamfer from the edge", |p| &mut p.outline.chamfer_width)
                .range(Range::Words("above 0 and at most half the inner diameter"))
                .with(Key::Top, &["chamfer"]).of_pattern(Q::ChamferWidth);
        EdgeRadius = "surface.pillar.edge_radius" is
            length("edge radius of a rounded top", |p| &mut p.outline.edge_radius)
                .range(Range::Words("above 0, at most half the inner diameter and at most the height"))
                .with(Key::Top, &["rounded"]).of_pattern(Q::EdgeRadius);
        PatternCompliance = "surface.pillar.compliance" is
            word("column: pillars shorten under load; or none", |p| &mut p.outline.compliance)
                .optional();
        GridCells = "surface.grid.cells_per_diameter" is
            number("cells across the narrowest diameter of a pillar, 4 or more", |p| &mut p.surface.grid_cells)
                .range(Range::Whole(4, 1024)).optional();
        GridWidth = "surface.grid.width" is
            length("width of the grid, which is centred; whole periods of a periodic lattice", |p| &mut p.surface.grid_width)
                .positive();
    }
    PillarPattern {
        MethodName = "method.name" is
            word("spectral (exact), love (boundary elements), punch or homogenised", |p| &mut p.method.name)
                .label("method")
                .optional();
        Accuracy = "method.accuracy" is
            word("accuracy of the spectral method: default or accurate", |p| &mut p.method.accuracy)
                .optional().with(Key::MethodName, &["spectral"]);
        Form = "method.form" is
            word("form of the punch method: corrected or plain", |p| &mut p.method.form)
                .optional().with(Key::MethodName, &["punch"]);
        CellsPerDiameter = "method.cells_per_diameter" is
            number("cells across a pillar with the method love, 8 or more", |p| &mut p.method.cells_per_diameter)
                .usual(8.0, 32.0)
                .range(Range::Whole(8, 1024)).optional().with(Key::MethodName, &["love"]);
        Mesh = "method.mesh" is
            word("mesh of the method love: a grid on every pillar, or one over the pattern", |p| &mut p.method.mesh)
                .optional().with(Key::MethodName, &["love"]);
        Cells = "method.cells" is
            word("cells of the method love: matched to a flat punch, or plain", |p| &mut p.method.cells)
                .optional().with(Key::MethodName, &["love"]);
    }
}

/// Keys whose presence sets another key that is not given: a table of heights is the shape of a lens, and a table of pillars their
/// arrangement. Key, key that it sets, and the word.
pub(crate) const IMPLIED: [(Key, Key, &str); 2] = [
    (Key::LensProfile, Key::LensShape, "profile"),
    (Key::Pillars, Key::Lattice, "listed"),
];

/// A row of the key table. The functions below create a row, and its methods add to it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Row {
    /// What it means, in a few words.
    pub(crate) summary: &'static str,
    /// Label of a control, if it differs from the name.
    pub(crate) label: Option<&'static str>,
    /// Its symbol in the paper.
    pub(crate) symbol: Option<&'static str>,
    /// Usual range, in SI units.
    pub(crate) usual: Option<[f64; 2]>,
    /// Deprecated path, which is still accepted.
    pub(crate) former: Option<&'static str>,
    /// Kind of its value, valid range, and field.
    pub(crate) field: Field,
    /// Whether it is required.
    pub(crate) presence: Presence,
    /// The key is accepted only if this other key has one of these words.
    pub(crate) goes_with: Option<(Key, &'static [&'static str])>,
    /// And if this one has one of these.
    pub(crate) goes_also_with: Option<(Key, &'static [&'static str])>,
    /// The key without which it is refused.
    pub(crate) needs: Option<Key>,
    /// Whether a case of pillars with flat tops is written without it.
    pub(crate) unwritten: fn(&Parts) -> bool,
    /// Name of the quantity in the solver, if the solver checks its value.
    pub(crate) quantity: Option<Quantity>,
    /// Name of the quantity in the patterns of pillars, if they check its value.
    pub(crate) pattern_quantity: Option<PatternQuantity>,
}

/// Kind and field of a value. The field is used both to write and to read the value.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Field {
    Number {
        dimension: Dimension,
        range: Range,
        place: fn(&mut Parts) -> &mut f64,
    },
    Word(fn(&mut Parts) -> &mut dyn Choice),
    Text(fn(&mut Parts) -> &mut String),
    List {
        dimension: Dimension,
        place: fn(&mut Parts) -> &mut Vec<f64>,
    },
}

/// Whether a key is required.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Presence {
    /// It is required.
    Required,
    /// Its default is the value in [`Parts::default`].
    Default,
    /// It has no value if left out; the text describes what applies then.
    Otherwise(&'static str),
    /// Exactly one of it and the other is required, if both are possible.
    OneOf(Key),
    /// As `OneOf`, but the two keys belong to different kinds of surfaces, so that an override of
    /// one does not replace the other.
    EitherSurface(Key),
}

/// Valid numbers of a key, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Range {
    /// Every finite number.
    Finite,
    /// Every finite length except zero.
    NotZero,
    /// Finite and positive.
    Positive,
    /// Between two numbers.
    Between(Bound<f64>, Bound<f64>),
    /// Integers from the first to the last.
    Whole(u64, u64),
    /// Positive, up to the value at which neighbouring discs of a hexagonal lattice touch.
    SurfaceFraction,
    /// Positive and below the value of another key.
    Below(Key),
    /// From zero to the value of another key.
    UpTo(Key),
    /// At least the value of another key.
    AtLeast(Key),
    /// A positive range that depends on several keys, as text.
    Words(&'static str),
}

impl Range {
    /// Smallest and largest number, except for bounds that depend on other keys.
    pub(crate) fn bounds(self) -> (Bound<f64>, Bound<f64>) {
        match self {
            Self::Finite | Self::NotZero => (Unbounded, Unbounded),
            Self::Positive | Self::Below(_) | Self::AtLeast(_) | Self::Words(_) => {
                (Excluded(0.0), Unbounded)
            }
            Self::UpTo(_) => (Included(0.0), Unbounded),
            Self::Between(lower, upper) => (lower, upper),
            Self::Whole(first, last) => (Included(first as f64), Included(last as f64)),
            Self::SurfaceFraction => (Excluded(0.0), Included(MAXIMUM_SURFACE_FRACTION)),
        }
    }

    /// Whether a number is in the range, except for bounds that depend on other keys.
    pub(crate) fn allows(self, value: f64) -> bool {
        let special = match self {
            Self::NotZero => value != 0.0,
            Self::Whole(..) => value.fract() == 0.0,
            _ => true,
        };
        let (lower, upper) = self.bounds();
        let above = match lower {
            Included(lower) => value >= lower,
            Excluded(lower) => value > lower,
            Unbounded => true,
        };
        let below = match upper {
            Included(upper) => value <= upper,
            Excluded(upper) => value < upper,
            Unbounded => true,
        };
        value.is_finite() && special && above && below
    }

    /// Representation of an invalid number in an error.
    pub(crate) fn refused(self, value: f64, dimension: Dimension) -> String {
        match self {
            // Only NaN, infinity and zero, in any unit, can be wrong here.
            Self::Finite | Self::NotZero => value.to_string(),
            _ => format_quantity(value, dimension),
        }
    }
}

/// Condition for a value, as in "it must be ...".
impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Finite => f.write_str("a finite number"),
            Self::NotZero => {
                f.write_str("a finite length other than 0; negative where the file has depths")
            }
            Self::Positive => Requirement::Positive.fmt(f),
            Self::Whole(first, last) => write!(f, "a whole number from {first} to {last}"),
            Self::SurfaceFraction => Requirement::SurfaceFraction.fmt(f),
            Self::Below(key) => write!(f, "greater than 0 and below {key}"),
            Self::UpTo(key) => write!(f, "from 0 to {key}"),
            Self::AtLeast(key) => write!(f, "at least {key}"),
            Self::Words(words) => f.write_str(words),
            Self::Between(Included(lower), Included(upper)) => write!(f, "from {lower} to {upper}"),
            Self::Between(Included(lower), Excluded(upper)) => {
                write!(f, "from {lower} to below {upper}")
            }
            Self::Between(Excluded(lower), Excluded(upper)) => {
                write!(f, "above {lower} and below {upper}")
            }
            Self::Between(Excluded(lower), Included(upper)) => {
                write!(f, "above {lower} and at most {upper}")
            }
            Self::Between(Included(lower), Unbounded) => write!(f, "at least {lower}"),
            Self::Between(Unbounded, _) | Self::Between(_, Unbounded) => {
                f.write_str("a finite number")
            }
        }
    }
}

impl Row {
    const fn new(summary: &'static str, field: Field) -> Self {
        Self {
            summary,
            label: None,
            symbol: None,
            usual: None,
            former: None,
            field,
            presence: Presence::Required,
            goes_with: None,
            goes_also_with: None,
            needs: None,
            unwritten: |_| false,
            quantity: None,
            pattern_quantity: None,
        }
    }

    const fn number(
        dimension: Dimension,
        summary: &'static str,
        place: fn(&mut Parts) -> &mut f64,
    ) -> Self {
        let range = Range::Finite;
        Self::new(
            summary,
            Field::Number {
                dimension,
                range,
                place,
            },
        )
    }

    /// Sets the valid range; without it, all finite numbers are valid.
    const fn range(mut self, allowed: Range) -> Self {
        if let Field::Number {
            dimension, place, ..
        } = self.field
        {
            self.field = Field::Number {
                dimension,
                range: allowed,
                place,
            };
        }
        self
    }

    const fn positive(self) -> Self {
        self.range(Range::Positive)
    }

    /// Sets the label of a control.
    const fn label(mut self, label: &'static str) -> Self {
        self.label = Some(label);
        self
    }

    /// Sets its symbol in the paper; the part after `_` is a subscript.
    const fn symbol(mut self, symbol: &'static str) -> Self {
        self.symbol = Some(symbol);
        self
    }

    /// Sets the usual range, in SI units, if the valid range is much larger.
    const fn usual(mut self, first: f64, last: f64) -> Self {
        self.usual = Some([first, last]);
        self
    }

    /// Sets the deprecated path.
    const fn formerly(mut self, path: &'static str) -> Self {
        self.former = Some(path);
        self
    }

    /// It may be left out; its default is the value in [`Parts::default`].
    const fn optional(self) -> Self {
        self.presence(Presence::Default)
    }

    /// It may be left out; the text describes what applies then.
    const fn otherwise(self, words: &'static str) -> Self {
        self.presence(Presence::Otherwise(words))
    }

    /// Exactly one of it and the other is required.
    const fn or(self, other: Key) -> Self {
        self.presence(Presence::OneOf(other))
    }

    const fn presence(mut self, presence: Presence) -> Self {
        self.presence = presence;
        self
    }

    /// It is accepted only if another key has one of these words.
    const fn with(mut self, choice: Key, words: &'static [&'static str]) -> Self {
        self.goes_with = Some((choice, words));
        self
    }

    /// It is accepted only if a further key has one of these words.
    const fn also_with(mut self, choice: Key, words: &'static [&'static str]) -> Self {
        self.goes_also_with = Some((choice, words));
        self
    }

    /// It is refused without another key.
    const fn needs(mut self, key: Key) -> Self {
        self.needs = Some(key);
        self
    }

    /// Cases of pillars with flat tops that have these values are written without it.
    const fn unwritten(mut self, when: fn(&Parts) -> bool) -> Self {
        self.unwritten = when;
        self
    }

    /// The solver checks the value under this name.
    const fn of(mut self, quantity: Quantity) -> Self {
        self.quantity = Some(quantity);
        self
    }

    /// The patterns of pillars check the value under this name.
    const fn of_pattern(mut self, quantity: PatternQuantity) -> Self {
        self.pattern_quantity = Some(quantity);
        self
    }
}

const fn length(summary: &'static str, place: fn(&mut Parts) -> &mut f64) -> Row {
    Row::number(Dimension::Length, summary, place)
}

const fn pressure(summary: &'static str, place: fn(&mut Parts) -> &mut f64) -> Row {
    Row::number(Dimension::Pressure, summary, place)
}

const fn energy_per_area(summary: &'static str, place: fn(&mut Parts) -> &mut f64) -> Row {
    Row::number(Dimension::EnergyPerArea, summary, place)
}

const fn angle(summary: &'static str, place: fn(&mut Parts) -> &mut f64) -> Row {
    Row::number(Dimension::Angle, summary, place)
}

const fn number(summary: &'static str, place: fn(&mut Parts) -> &mut f64) -> Row {
    Row::number(Dimension::Number, summary, place)
}

const fn fraction(summary: &'static str, place: fn(&mut Parts) -> &mut f64) -> Row {
    Row::number(Dimension::Fraction, summary, place)
}

const fn word(summary: &'static str, place: fn(&mut Parts) -> &mut dyn Choice) -> Row {
    Row::new(summary, Field::Word(place))
}

const fn list(
    dimension: Dimension,
    summary: &'static str,
    place: fn(&mut Parts) -> &mut Vec<f64>,
) -> Row {
    Row::new(summary, Field::List { dimension, place })
}

const fn text(summary: &'static str, place: fn(&mut Parts) -> &mut String) -> Row {
    Row::new(summary, Field::Text(place))
}
