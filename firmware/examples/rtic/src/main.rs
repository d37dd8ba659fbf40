//! Homes an axis on its index with RTIC. A hardware task runs each period of the servo. The
//! foreground is `idle`. The axis is a resource that both lock. The crates do not depend on RTIC.
#![no_std]
#![no_main]

use cortex_m_rt as _;

#[path = "../../block/src/motor.rs"]
mod motor;
mod mps2;

#[rtic::app(device = crate::mps2, peripherals = false)]
mod app {
    use crate::motor::{GAINS, INDEX, Motor};
    use crate::mps2;
    use husillo_machine::{ServoAxis, ServoEvents, ServoStop};
    use husillo_pid::{RateRule, ServoLaw, TotalLimit};
    use husillo_planner::ServoMotion;
    use semihosting::println;

    /// The period of a PIC-SERVO module.
    const PERIOD_US: u32 = 512;

    #[shared]
    struct Shared {
        axis: ServoAxis,
    }

    #[local]
    struct Local {
        motor: Motor,
    }

    #[init]
    fn init(_: init::Context) -> (Shared, Local) {
        let mut axis = ServoAxis::new(ServoLaw::new(
            &GAINS,
            RateRule::Loop,
            TotalLimit::BeforeScaling,
        ));
        let motor = Motor::default();
        // One period runs before anything moves, so that the axis has read its inputs.
        axis.tick(&motor.read());
        let events = ServoEvents {
            index: true,
            ..ServoEvents::default()
        };
        axis.search(events, Some(ServoStop::Smooth));
        axis.load(ServoMotion::Trapezoid {
            goal: 5_000,
            velocity: 1 << 16,
            acceleration: 1 << 10,
        });
        axis.start();
        mps2::start(PERIOD_US);
        (Shared { axis }, Local { motor })
    }

    #[idle(shared = [axis])]
    fn idle(mut context: idle::Context) -> ! {
        let home = nb::block!(context.shared.axis.lock(|axis| axis.poll_search()));
        println!("home: {home:?}");
        assert!(home.is_ok_and(|home| (INDEX..INDEX + 2).contains(&home)));
        semihosting::process::exit(0)
    }

    #[task(binds = TIMER0, priority = 2, shared = [axis], local = [motor])]
    fn period(mut context: period::Context) {
        mps2::acknowledge();
        let motor = context.local.motor;
        let drive = context.shared.axis.lock(|axis| axis.tick(&motor.read()));
        motor.turn(drive);
    }
}
