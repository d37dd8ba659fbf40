//! A quadrature encoder at two pins.

use husillo_book::pin::Pin;
use husillo_encoder::{QuadraturePins, SampleError, Scale};
use std::convert::Infallible;

/// An encoder disc: both levels follow from its angle in edges.
struct Disc {
    angle: i32,
    a: Pin,
    b: Pin,
}

impl Disc {
    fn turn(&mut self, edges: i32) {
        self.angle += edges;
        let (a, b) = [(false, false), (true, false), (true, true), (false, true)]
            [self.angle.rem_euclid(4) as usize];
        self.a.set(a);
        self.b.set(b);
    }
}

fn main() -> Result<(), SampleError<Infallible>> {
    let mut disc = Disc {
        angle: 0,
        a: Pin::default(),
        b: Pin::default(),
    };
    // ANCHOR: count
    let mut encoder = QuadraturePins::new(disc.a.clone(), disc.b.clone(), Scale::X4)?;
    for (edges, direction) in [(1000, 1), (300, -1)] {
        for _ in 0..edges {
            disc.turn(direction);
            encoder.sample()?; // in the interrupt of both pins
        }
        let state = encoder.quadrature();
        println!(
            "position {}, last direction {:?}",
            state.position(),
            state.direction()
        );
    }
    assert_eq!(encoder.quadrature().position(), 700);
    // ANCHOR_END: count

    // ANCHOR: skipped
    // Two edges between two samples: the decoder cannot know in which direction.
    disc.turn(2);
    assert_eq!(encoder.sample(), Err(SampleError::Skipped));
    let state = encoder.quadrature();
    println!("position {}, skipped {}", state.position(), state.skipped());
    // ANCHOR_END: skipped
    assert_eq!((state.position(), state.skipped()), (700, 1));
    Ok(())
}
