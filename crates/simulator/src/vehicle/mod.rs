//! The car: what throttle, brake and steering do to where it is.

pub(crate) mod kinematic;

pub(crate) use kinematic::KinematicBicycle;
