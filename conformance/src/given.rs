//! A scene given number by number: what fuzzing finds, and [`crate::regressions`] keep.

use std::fmt;

use laguerre_core::diagram::bounding_box;
use laguerre_core::oracle::Naive;
use laguerre_core::{Backend, PowerDiagram, Request};

use crate::bounds::Planes;
use crate::domains::{self, Pose, Room, Shape};
use crate::{Scene, Verdict, compare, sanity};

/// Sites, weights (or none) and a room; `None` is the bounding box of the sites, which the diagram is not told.
#[derive(Clone, Copy, PartialEq)]
pub struct Given<'a> {
    /// The container.
    pub room: Option<(Shape, Pose)>,
    /// Sites (length).
    pub positions: &'a [[f64; 3]],
    /// Weights (length²), or none.
    pub weights: &'a [f64],
}

impl Given<'_> {
    /// The scene.
    pub fn scene(&self) -> Scene {
        let room = self.room.map(|(shape, pose)| domains::room(shape, pose));
        let (lo, hi) = bounding_box(self.positions);
        let room = room.unwrap_or(Room::Box(lo, hi));
        Scene { positions: self.positions.to_vec(), weights: self.weights.to_vec(), room }
    }

    /// Holds what `backend` makes of it to every law of one output.
    ///
    /// # Errors
    /// The library's, or the law that is broken.
    pub fn sane(&self, backend: &dyn Backend, request: &Request) -> Verdict {
        let scene = self.scene();
        let diagram = match self.room {
            Some(_) => scene.diagram()?,
            None => PowerDiagram::new(self.positions, self.weights).map_err(|error| error.to_string())?,
        };
        let output = backend.evaluate(&diagram, request).map_err(|error| error.to_string())?;
        sanity::check(&scene, request, &output)
    }

    /// Holds what `backend` makes of it to the naive oracle.
    ///
    /// # Errors
    /// The library's, or how they differ.
    pub fn like_the_oracle(&self, backend: &dyn Backend) -> Verdict {
        let (scene, request) = (self.scene(), Request::moments().with_facets().with_second_moments());
        let naive = scene.evaluate(&Naive::default(), &request)?;
        compare::same(&scene, &naive, &scene.evaluate(backend, &request)?, Planes::Same)
    }

    /// Both: what a regression is held to.
    ///
    /// # Errors
    /// The library's, or what is wrong.
    pub fn holds(&self, backend: &dyn Backend) -> Verdict {
        self.sane(backend, &Request::moments().with_facets().with_second_moments())?;
        self.like_the_oracle(backend)
    }
}

impl fmt::Debug for Given<'_> {
    /// As Rust, so that a failing scene can be pasted.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { room, positions, weights } = self;
        match room {
            Some((shape, pose)) => write!(f, "Given {{ room: Some((Shape::{shape:?}, Pose::{pose:?})), ")?,
            None => write!(f, "Given {{ room: None, ")?,
        }
        write!(f, "positions: &{positions:?}, weights: &{weights:?} }}")
    }
}
