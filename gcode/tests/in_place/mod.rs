//! A plan made in place, checked against the copied one.

use husillo_gcode::{Block, Commands, Error, Modal};

/// Plans a block. Asserts that the plan in place is the same, that looking at its commands takes
/// none of them, and that the whole modal state is as before when the block is taken back, however
/// many of its commands have been taken.
pub fn plan<const N: usize>(
    modal: &Modal<N>,
    block: &Block,
) -> Result<(Modal<N>, Commands<N>), Error> {
    let planned = modal.plan(block);
    for taken in [0, 1, usize::MAX] {
        let (mut changed, mut commands) = (modal.clone(), Commands::new());
        let applied = changed.apply(block, &mut commands);
        match &planned {
            Ok((next, expected)) => {
                assert_eq!(applied, Ok(()));
                assert_eq!(&changed, next);
                // A cycle has up to 2^21 moves.
                assert!(commands.pending().take(100).eq(expected.clone().take(100)));
                assert!(commands.by_ref().take(taken.min(100)).count() <= taken);
                changed.revert(&mut commands);
            }
            Err(error) => assert_eq!(applied.as_ref(), Err(error)),
        }
        assert_eq!(&changed, modal);
        assert!(commands.is_empty());
        // A second time there is nothing to take back.
        changed.revert(&mut commands);
        assert_eq!(&changed, modal);
    }
    planned
}
