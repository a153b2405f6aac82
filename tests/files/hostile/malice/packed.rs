//! Archives and compressed bytes that no program would write, put together byte by byte.

/// A zip archive. The sizes of its entries need not be true.
#[derive(Default)]
pub(crate) struct Zip {
    /// The entries, each after its header.
    bytes: Vec<u8>,
    /// The directory, which comes at the end.
    directory: Vec<u8>,
    /// The number of entries.
    count: u16,
}

/// The compression of an entry.
#[derive(Clone, Copy)]
pub(crate) enum Packing {
    /// No compression.
    Stored = 0,
    /// Deflate.
    Deflated = 8,
}

impl Zip {
    /// Adds an entry that claims an unpacked size of `claimed` bytes.
    pub(crate) fn with(
        mut self,
        name: &str,
        packing: Packing,
        content: &[u8],
        claimed: u64,
    ) -> Self {
        let offset = self.bytes.len();
        let head = head(name, packing, content, claimed);
        self.bytes.extend(b"PK\x03\x04");
        self.bytes.extend(&head);
        self.bytes.extend(tail(name, content, claimed));
        self.bytes.extend(content);
        self.refer(name, packing, content, claimed, offset);
        self
    }

    /// Adds an entry to the directory that refers to the bytes at `offset`.
    fn refer(&mut self, name: &str, packing: Packing, content: &[u8], claimed: u64, offset: usize) {
        let head = head(name, packing, content, claimed);
        self.directory.extend(b"PK\x01\x02\x2d\x00");
        self.directory.extend(&head);
        // No comment, the first disk, no attributes.
        self.directory.extend([0; 10]);
        self.directory.extend(least(offset).to_le_bytes());
        self.directory.extend(tail(name, content, claimed));
        self.count += 1;
    }

    /// Adds `count` more entries that share the bytes of the first one.
    pub(crate) fn with_shared(mut self, count: u16, content: &[u8]) -> Self {
        for number in 0..count {
            let name = format!("{number:05}.npy");
            self.refer(&name, Packing::Deflated, content, content.len() as u64, 0);
        }
        self
    }

    /// Returns the finished archive.
    pub(crate) fn finish(mut self) -> Vec<u8> {
        let (start, length) = (least(self.bytes.len()), least(self.directory.len()));
        self.bytes.append(&mut self.directory);
        self.bytes.extend(b"PK\x05\x06\0\0\0\0");
        self.bytes.extend([self.count.to_le_bytes(); 2].concat());
        self.bytes
            .extend([length.to_le_bytes(), start.to_le_bytes()].concat());
        self.bytes.extend([0; 2]);
        self.bytes
    }
}

fn least(number: usize) -> u32 {
    u32::try_from(number).expect("it is short")
}

/// Returns the part that both headers of an entry share, from the version to the lengths of name and extra field. The
/// sizes are in the extra field.
fn head(name: &str, packing: Packing, content: &[u8], claimed: u64) -> Vec<u8> {
    let checksum = if claimed == content.len() as u64 {
        crc32fast::hash(content)
    } else {
        0
    };
    [
        &45_u16.to_le_bytes()[..],
        &[0; 2],
        &(packing as u16).to_le_bytes(),
        // 1 January 1980.
        &[0, 0, 0x21, 0],
        &checksum.to_le_bytes(),
        &[0xff; 8],
        &u16::try_from(name.len()).expect("short").to_le_bytes(),
        &20_u16.to_le_bytes(),
    ]
    .concat()
}

/// Returns the name, and the extra field with both sizes in 64 bits.
fn tail(name: &str, content: &[u8], claimed: u64) -> Vec<u8> {
    [
        name.as_bytes(),
        &[1, 0, 16, 0],
        &claimed.to_le_bytes(),
        &(content.len() as u64).to_le_bytes(),
    ]
    .concat()
}

/// Returns deflated data: `start`, then 158 zeros for each further byte up to `length`.
pub(crate) fn zeros_after(start: &[u8], length: usize) -> Vec<u8> {
    let stored = u16::try_from(start.len()).expect("short");
    // An uncompressed block, then one with the fixed code.
    let mut packed = [
        &[0][..],
        &stored.to_le_bytes(),
        &(!stored).to_le_bytes(),
        start,
    ]
    .concat();
    let mut bits: Vec<bool> = Vec::new();
    bits.extend([false, true, false]);
    // A zero, then copies of 258 bytes at a distance of one byte.
    bits.extend("00110000".bytes().map(|bit| bit == b'1'));
    let copy: Vec<bool> = "1100010100000".bytes().map(|bit| bit == b'1').collect();
    while packed.len() + bits.len() / 8 < length {
        bits.extend(&copy);
    }
    for byte in bits.chunks(8) {
        let bits = byte.iter().enumerate();
        packed.push(bits.map(|(place, &bit)| u8::from(bit) << place).sum());
    }
    packed
}
