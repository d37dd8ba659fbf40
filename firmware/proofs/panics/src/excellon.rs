//! The public functions of `husillo-excellon`.

use core::hint::black_box;

use husillo_excellon::{
    Digits, ErrorKind, Features, Inference, Lines, Reader, Repeat, Settings, Tools, Units,
    WarningKind, lines,
};

/// Keeps every function in the program.
#[unsafe(export_name = "excellon")]
pub fn keep() {
    black_box([
        lines as *const (),
        <Lines as Iterator>::next as *const (),
        Inference::new as *const (),
        Inference::observe as *const (),
        Inference::settle as *const (),
        Settings::format as *const (),
        Reader::<8>::new as *const (),
        Reader::<8>::set_tool as *const (),
        Reader::<8>::tools as *const (),
        Reader::<8>::warning as *const (),
        Reader::<8>::is_ended as *const (),
        Reader::<8>::format as *const (),
        Reader::<8>::read as *const (),
        Reader::<8>::with_patterns as *const (),
        Reader::<8>::pattern as *const (),
        Repeat::copy as *const (),
        Tools::<8>::get as *const (),
        Tools::<8>::iter as *const (),
        <Features as Iterator>::next as *const (),
        <Features as Iterator>::size_hint as *const (),
        Digits::new as *const (),
        Digits::whole as *const (),
        Digits::places as *const (),
        Digits::all as *const (),
        Units::digits as *const (),
        ErrorKind::code as *const (),
        WarningKind::code as *const (),
    ]);
}
