//! Power failures in every operation of a save, and in random operations of many saves.

#[path = "../examples/flash/mod.rs"]
mod flash;

use flash::{Failure, Flash};
use husillo_store::{Store, StoreError};
use proptest::prelude::*;

fn save<const UNIT: usize>(
    flash: &mut Flash<UNIT>,
    content: &[u8],
) -> Result<(), StoreError<Failure>> {
    let end = flash.bytes.len() as u32;
    let mut store = Store::open(flash, 0..end)?;
    let mut save = store.save()?;
    for part in content.chunks(7) {
        save.write(part)?;
    }
    save.commit()
}

fn content<const UNIT: usize>(flash: &mut Flash<UNIT>) -> Option<Vec<u8>> {
    let end = flash.bytes.len() as u32;
    let mut store = Store::open(flash, 0..end).unwrap();
    let mut content = vec![0; store.len()? as usize];
    store.read(0, &mut content).unwrap();
    Some(content)
}

/// The content is the old or the new one, for a power failure in any operation with any partial
/// result. The next save works.
fn survives<const UNIT: usize>() {
    let [old, new] = [b"old".repeat(50), b"newer".repeat(45)];
    let mut before = Flash::<UNIT>::new(4, 256);
    // Uses both halves.
    save(&mut before, &new).unwrap();
    save(&mut before, &old).unwrap();
    let mut operations = 0;
    let mut are_new = 0;
    loop {
        let mut is_done = false;
        for seed in 1..=20_u64 {
            let mut flash = before.clone();
            flash.power = Some((operations, seed * 0x9e37_79b9));
            is_done = save(&mut flash, &new).is_ok();
            flash.power = None;
            let found = content(&mut flash);
            assert!(
                found.as_ref() == Some(&old) || found.as_ref() == Some(&new),
                "{operations} {seed} {found:?}"
            );
            assert!(!is_done || found.as_ref() == Some(&new));
            are_new += u32::from(!is_done && found.as_ref() == Some(&new));
            save(&mut flash, b"next").unwrap();
            assert_eq!(content(&mut flash).unwrap(), b"next");
        }
        if is_done {
            break;
        }
        operations += 1;
    }
    // Operations: two sectors, the content, the header.
    assert_eq!(
        operations,
        2 + 225_usize.div_ceil(UNIT) + 16_usize.div_ceil(UNIT)
    );
    // The content is new only if the failed write completed the header.
    assert!(are_new <= 20);
}

#[test]
fn power_may_fail_in_any_operation() {
    survives::<1>();
    survives::<4>();
    survives::<8>();
    survives::<32>();
}

#[test]
fn a_content_is_as_long_as_half_of_the_area_but_the_header() {
    let mut flash = Flash::<8>::new(2, 256);
    save(&mut flash, &[7; 240]).unwrap();
    assert_eq!(save(&mut flash, &[8; 241]), Err(StoreError::Full));
    assert_eq!(content(&mut flash), Some(vec![7; 240]));
    // A write that is too long writes none of its bytes.
    let mut store = Store::open(&mut flash, 0..512).unwrap();
    let mut save = store.save().unwrap();
    save.write(&[1; 200]).unwrap();
    assert_eq!(save.write(&[2; 41]), Err(StoreError::Full));
    save.write(&[3; 40]).unwrap();
    save.commit().unwrap();
    assert_eq!((store.len(), store.capacity()), (Some(240), 240));
    let mut ends = [0; 2];
    store.read(199, &mut ends).unwrap();
    assert_eq!(ends, [1, 3]);
    assert_eq!(store.read(239, &mut ends), Err(StoreError::Nothing));
    assert_eq!(store.read(u32::MAX, &mut ends), Err(StoreError::Nothing));
}

#[test]
fn areas_are_whole_sectors_of_the_flash() {
    for area in [0..0, 0..256, 0..500, 128..640, 0..768, 512..1536] {
        assert_eq!(
            Store::open(Flash::<4>::new(4, 256), area).err(),
            Some(StoreError::Area)
        );
    }
    let mut store = Store::open(Flash::<4>::new(4, 256), 256..768).unwrap();
    assert_eq!((store.len(), store.is_empty()), (None, true));
    assert_eq!(store.read(0, &mut []), Err(StoreError::Nothing));
    let mut save = store.save().unwrap();
    save.write(&[0; 240]).unwrap();
    save.commit().unwrap();
    let flash = store.release();
    assert!(
        flash.bytes[..256]
            .iter()
            .chain(&flash.bytes[768..])
            .all(|byte| *byte == 0xff)
    );
}

#[test]
fn what_is_not_committed_is_not_there() {
    let mut flash = Flash::<4>::new(2, 256);
    save(&mut flash, b"old").unwrap();
    let mut store = Store::open(&mut flash, 0..512).unwrap();
    store.save().unwrap().write(b"new").unwrap();
    assert_eq!(store.len(), Some(3));
    assert_eq!(content(&mut flash), Some(b"old".to_vec()));
}

proptest! {
    /// Saves of any contents with power failures anywhere: the content found is the last one
    /// committed or the one after it.
    #[test]
    fn rows_of_saves(
        saves in proptest::collection::vec(
            (proptest::collection::vec(any::<u8>(), 0..240), 0_usize..100, 1_u64..),
            1..12,
        ),
    ) {
        let mut flash = Flash::<4>::new(2, 256);
        let mut last = None;
        for (bytes, operations, seed) in saves {
            flash.power = Some((operations, seed));
            let is_done = save(&mut flash, &bytes).is_ok();
            flash.power = None;
            let found = content(&mut flash);
            prop_assert!(found == Some(bytes) || !is_done && found == last);
            last = found;
        }
    }

    /// A wrong bit anywhere leaves the content, the one before it, or none; never another.
    #[test]
    fn a_wrong_bit(
        contents in proptest::collection::vec(proptest::collection::vec(any::<u8>(), 0..240), 1..4),
        bit in 0_usize..4096,
    ) {
        let mut flash = Flash::<4>::new(2, 256);
        for content in &contents {
            save(&mut flash, content).unwrap();
        }
        flash.bytes[bit / 8] ^= 1 << (bit % 8);
        let newest = contents.iter().rev().take(2).cloned();
        let found = content(&mut flash);
        prop_assert!(
            found.is_none() && contents.len() == 1 || newest.map(Some).any(
                |content| content == found
            )
        );
    }
}
