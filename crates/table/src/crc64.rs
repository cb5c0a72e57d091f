//! CRC-64/XZ: detects every error burst of up to 64 bits, and all but one in 2^64 of the others.

/// Reflected polynomial of ECMA-182.
const POLYNOMIAL: u64 = 0xC96C_5795_D787_0F42;

/// Remainders of the 16 nibbles: 128 bytes instead of the usual 2 KiB, for small machines.
const NIBBLES: [u64; 16] = nibbles();

const fn nibbles() -> [u64; 16] {
    let mut table = [0; 16];
    let mut i = 0;
    while i < 16 {
        let mut rest = i as u64;
        let mut bit = 0;
        while bit < 4 {
            rest = if rest & 1 == 1 { rest >> 1 ^ POLYNOMIAL } else { rest >> 1 };
            bit += 1;
        }
        table[i] = rest;
        i += 1;
    }
    table
}

/// The CRC-64/XZ of bytes.
///
/// ```
/// assert_eq!(bulge_table::crc64(b"123456789"), 0x995D_C9BB_DF19_39FA); // the check value of the catalogue of CRCs
/// ```
#[must_use]
pub fn crc64(bytes: &[u8]) -> u64 {
    let step = |crc: u64| NIBBLES[(crc & 15) as usize] ^ crc >> 4;
    !bytes.iter().fold(!0, |crc, byte| step(step(crc ^ u64::from(*byte))))
}
