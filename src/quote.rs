//! Truncates untrusted text for messages. Text from files and arguments may be a megabyte long.

/// Text to be quoted inside a message: at most 40 characters, then `…`.
pub(crate) fn shortened(text: &str) -> String {
    cut(text, 40)
}

/// A message that quotes untrusted text in full: at most 400 characters, then `…`.
#[cfg(feature = "json")]
pub(crate) fn shortened_message(message: &str) -> String {
    cut(message, 400)
}

/// Whether a character shows nothing but changes the text around it, or stands for a blank that looks like nothing:
/// Unicode's format characters, and letters without a shape of their own, such as the Hangul filler. Text from others
/// must not hide behind them.
pub(crate) fn is_invisible(character: char) -> bool {
    matches!(
        character,
        '\u{ad}' | '\u{34f}' | '\u{61c}' | '\u{115f}'..='\u{1160}' | '\u{17b4}'..='\u{17b5}'
            | '\u{180b}'..='\u{180f}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
            | '\u{2060}'..='\u{206f}' | '\u{3164}' | '\u{feff}' | '\u{ffa0}' | '\u{fff0}'..='\u{fffb}'
            | '\u{1bca0}'..='\u{1bca3}' | '\u{1d173}'..='\u{1d17a}' | '\u{e0000}'..='\u{e0fff}'
    )
}

/// The first `longest` characters of a text, with `…` behind them if there are more.
fn cut(text: &str, longest: usize) -> String {
    match text.char_indices().nth(longest) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
