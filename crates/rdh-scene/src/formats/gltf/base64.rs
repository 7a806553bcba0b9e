//! Base64, as in data URIs (RFC 4648, section 4).

/// Decodes; `None` if a character is not of the alphabet or the length is impossible. Padding may be missing.
pub(super) fn decode(text: &[u8]) -> Option<Vec<u8>> {
    let end = text.iter().rposition(|&b| b != b'=').map_or(0, |last| last + 1);
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(end / 4 * 3 + 3).ok()?;
    for group in text[..end].chunks(4) {
        let mut bits = 0;
        for &character in group {
            bits = bits << 6 | u32::from(sextet(character)?);
        }
        bits <<= 6 * (4 - group.len());
        // 4 characters are 3 bytes, 3 are 2, 2 are 1; a single one is none.
        let count = group.len().checked_sub(1).filter(|&count| count > 0)?;
        bytes.extend_from_slice(&bits.to_be_bytes()[1..=count]);
    }
    Some(bytes)
}

fn sextet(character: u8) -> Option<u8> {
    Some(match character {
        b'A'..=b'Z' => character - b'A',
        b'a'..=b'z' => character - b'a' + 26,
        b'0'..=b'9' => character - b'0' + 52,
        b'+' => 62,
        b'/' => 63,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::decode;

    #[test]
    fn decodes_the_vectors_of_the_rfc() {
        for (text, bytes) in
            [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYg==", "foob"), ("Zm9vYmE", "fooba")]
        {
            assert_eq!(decode(text.as_bytes()).as_deref(), Some(bytes.as_bytes()), "{text}");
        }
        assert_eq!(decode(b"+/+/"), Some(vec![0xfb, 0xff, 0xbf]));
    }

    #[test]
    fn refuses_what_is_not_base64() {
        for text in ["Z", "Zm9vY", "Zm 9", "Zm9v-A==", "Z=9v"] {
            assert_eq!(decode(text.as_bytes()), None, "{text}");
        }
    }
}
