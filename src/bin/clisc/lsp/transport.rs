//! Frames in, messages out: the base protocol.
//!
//! What is no message is told of and skipped, so that one bad frame does not end the conversation.

use std::io::{self, BufRead, Read, Write};

use lsp_server::{ErrorCode, Message};
use serde_json::{Value, json};

/// The longest frame that is read, in bytes: a scene of 4 GiB cannot be opened anyway.
const MAX_FRAME: u64 = 1 << 30;
/// The longest line of a frame's head.
const MAX_HEAD_LINE: u64 = 1 << 12;

/// What a frame holds.
#[derive(Debug)]
pub enum Frame {
    /// A message.
    Message(Message),
    /// No message; this is the answer.
    Malformed(Value),
}

/// Reads the next frame; none at the end of the input.
///
/// # Errors
/// When the input cannot be read.
pub fn read(input: &mut impl BufRead) -> io::Result<Option<Frame>> {
    let Some(head) = read_head(input)? else { return Ok(None) };
    let Some(n_bytes) = head else {
        return Ok(Some(malformed(ErrorCode::ParseError, &Value::Null, "a frame without a sound Content-Length")));
    };
    if n_bytes > MAX_FRAME {
        io::copy(&mut input.take(n_bytes), &mut io::sink())?;
        return Ok(Some(malformed(ErrorCode::InvalidRequest, &Value::Null, "a frame of more than 1 GiB")));
    }
    let mut body = Vec::new();
    if (input.take(n_bytes).read_to_end(&mut body)? as u64) < n_bytes {
        return Ok(None);
    }
    Ok(Some(parse(&body)))
}

/// Reads the head of a frame: its length, if it tells one. None at the end of the input.
fn read_head(input: &mut impl BufRead) -> io::Result<Option<Option<u64>>> {
    let mut n_bytes = None;
    loop {
        let mut line = Vec::new();
        if input.take(MAX_HEAD_LINE).read_until(b'\n', &mut line)? == 0 {
            return Ok(None);
        }
        let line = String::from_utf8_lossy(&line);
        let line = line.trim_end();
        if line.is_empty() {
            return Ok(Some(n_bytes));
        }
        if let Some((name, value)) = line.split_once(':')
            && name.trim().eq_ignore_ascii_case("content-length")
        {
            n_bytes = value.trim().parse().ok();
        }
    }
}

fn parse(body: &[u8]) -> Frame {
    let value: Value = match serde_json::from_slice(body) {
        Ok(value) => value,
        Err(error) => return malformed(ErrorCode::ParseError, &Value::Null, &error.to_string()),
    };
    let id = value.get("id").filter(|id| id.is_i64() || id.is_string()).cloned().unwrap_or_default();
    match serde_json::from_value(value) {
        Ok(message) => Frame::Message(message),
        Err(_) => malformed(ErrorCode::InvalidRequest, &id, "no request, response or notification"),
    }
}

fn malformed(code: ErrorCode, id: &Value, message: &str) -> Frame {
    let error = json!({ "code": code as i32, "message": message });
    Frame::Malformed(json!({ "jsonrpc": "2.0", "id": id, "error": error }))
}

/// Writes a frame.
///
/// # Errors
/// When the output cannot be written.
pub fn write(out: &mut dyn Write, body: &[u8]) -> io::Result<()> {
    write!(out, "Content-Length: {}\r\n\r\n", body.len())?;
    out.write_all(body)?;
    out.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bad_frame_does_not_hide_the_next() {
        let ping = r#"{"jsonrpc":"2.0","method":"exit"}"#;
        let frame = |body: &str| format!("Content-Length: {}\r\n\r\n{body}", body.len());
        let text = [
            &frame("{"),
            "nonsense\r\n\r\n",
            "Content-Length: x\r\n\r\n",
            &frame(r#"{"id":7,"method":3}"#),
            &frame("[]"),
            "content-type: a\r\ncontent-length:2\n\n{}",
            &frame(ping),
            "Content-Length: 99\r\n\r\n{",
        ]
        .concat();
        let mut input = text.as_bytes();
        let mut codes = Vec::new();
        while let Some(frame) = read(&mut input).unwrap() {
            codes.push(match frame {
                Frame::Message(_) => 0,
                Frame::Malformed(answer) => answer["error"]["code"].as_i64().unwrap(),
            });
        }
        assert_eq!(codes, [-32700, -32700, -32700, -32600, -32600, -32600, 0]);
    }
}
