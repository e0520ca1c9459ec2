//! Figures of contacts between a lens and a surface patterned with pillars, as SVG and PNG.
