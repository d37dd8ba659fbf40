//! The functions that JavaScript calls.
//!
//! 1. [`husillo_allocate`] gives memory, and the request is written there.
//! 2. [`husillo_call`] frees it, and returns the address of the answer. Its length is
//!    [`husillo_answer_length`].
//! 3. [`husillo_forget`] frees the answer.
//!
//! A call that panics ends in a trap. Then [`husillo_panic`] gives the reason as an answer.

#![allow(unsafe_code)]

use crate::calls;
use std::cell::RefCell;
use std::sync::Once;

thread_local! {
    static ANSWER: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static REASON: RefCell<String> = const { RefCell::new(String::new()) };
}

static HOOK: Once = Once::new();

/// Memory for a request of this length; null if there is none.
#[unsafe(no_mangle)]
pub extern "C" fn husillo_allocate(length: usize) -> *mut u8 {
    let mut bytes = Vec::<u8>::new();
    if bytes.try_reserve_exact(length).is_err() {
        return std::ptr::null_mut();
    }
    bytes.resize(length, 0);
    Box::into_raw(bytes.into_boxed_slice()).cast()
}

/// Answers a request, and frees it. Returns the address of the answer.
///
/// # Safety
///
/// `request` is from [`husillo_allocate`] with this length, and was not used in a call before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn husillo_call(request: *mut u8, length: usize) -> *const u8 {
    HOOK.call_once(|| {
        std::panic::set_hook(Box::new(|panic| {
            REASON.with(|reason| *reason.borrow_mut() = panic.to_string());
        }));
    });
    let bytes = std::ptr::slice_from_raw_parts_mut(request, length);
    // SAFETY: the caller gives back what `husillo_allocate` made with `Box::into_raw`.
    let request = unsafe { Box::from_raw(bytes) };
    let answer = calls::answer(&request);
    drop(request);
    keep(answer)
}

/// Length of the answer.
#[unsafe(no_mangle)]
pub extern "C" fn husillo_answer_length() -> usize {
    ANSWER.with(|kept| kept.borrow().len())
}

/// Frees the answer.
#[unsafe(no_mangle)]
pub extern "C" fn husillo_forget() {
    ANSWER.with(|kept| *kept.borrow_mut() = Vec::new());
}

/// The reason of a trap as an answer: its address.
#[unsafe(no_mangle)]
pub extern "C" fn husillo_panic() -> *const u8 {
    let reason = REASON.with(|reason| std::mem::take(&mut *reason.borrow_mut()));
    keep(calls::failure(format!("fault in husillo: {reason}")))
}

fn keep(answer: Vec<u8>) -> *const u8 {
    ANSWER.with(|kept| {
        let mut kept = kept.borrow_mut();
        *kept = answer;
        kept.as_ptr()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn call(request: &[u8]) -> Vec<u8> {
        let memory = husillo_allocate(request.len());
        // SAFETY: the memory has this length, and is used in one call.
        let answer = unsafe {
            std::ptr::copy_nonoverlapping(request.as_ptr(), memory, request.len());
            husillo_call(memory, request.len())
        };
        // SAFETY: the answer has this length until it is forgotten.
        let answer = unsafe { std::slice::from_raw_parts(answer, husillo_answer_length()) };
        let answer = answer.to_vec();
        husillo_forget();
        assert_eq!(husillo_answer_length(), 0);
        answer
    }

    #[test]
    fn requests_that_are_none_are_answered() {
        let long = [255, 255, 255, 255, b'{'];
        for request in [&b""[..], b"\0\0\0", b"\x02\0\0\0{}", b"\x01\0\0\0}", &long] {
            let answer = String::from_utf8(call(request)[4..].to_vec()).unwrap();
            assert!(answer.starts_with("{\"error\":"), "{answer}");
        }
    }
}
