//! Actions of `husillo jog`, one after the other.

use crate::console::reporter::{Reporter, action as action_object, report};
use husillo_clients::ByHand;

/// Carries out actions and prints their results. `port` names the machine. Returns whether all
/// actions succeeded: the first failure is the last action.
pub fn carry_out<H: ByHand>(
    port: &str,
    actions: &[H::Action],
    hand: &mut H,
    out: &mut Reporter<'_>,
) -> bool {
    for action in actions {
        let start = hand.elapsed();
        let made = hand.carry_out(action);
        for line in hand.panel() {
            out.tell(format_args!("  {line}"), || report(1, port, &line));
        }
        let seconds = (hand.elapsed() - start).as_secs_f64();
        let end = made.as_deref().map_err(String::as_str);
        out.object(&action_object(1, port, action, seconds, end));
        match end {
            Ok(how) => out.text(format_args!("{action}: {seconds:.1} s, {how}")),
            Err(sentence) => {
                if !out.is_json() {
                    eprintln!("error: {port}: {action}: {sentence}");
                }
                return false;
            }
        }
    }
    true
}
