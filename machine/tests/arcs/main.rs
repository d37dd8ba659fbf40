//! Arcs on machines with ramps.

mod off_radius;
mod router;
mod whole_acceleration;
