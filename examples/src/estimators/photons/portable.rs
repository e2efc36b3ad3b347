//! Photons and importons that several processes trace together.

use photon_map::{FluxWords, PhotonMaps, Photons};

use super::importons::Importons;
use crate::distributed::Portable;

/// Two collections, of which all bytes are.
fn two<A: FluxWords, B: FluxWords>(mut bytes: &[u8]) -> Result<(Photons<A>, Photons<B>), String> {
    let read = |bytes: &mut &[u8]| Ok((Photons::read_bytes(bytes)?, Photons::read_bytes(bytes)?));
    let both = read(&mut bytes).map_err(|error: photon_map::PhotonBytesError| error.to_string())?;
    if bytes.is_empty() { Ok(both) } else { Err(format!("{} bytes too many", bytes.len())) }
}

impl Portable for PhotonMaps<[f32; 3]> {
    const NAME: &'static str = "photons";

    fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.caustic.write_bytes(&mut bytes);
        self.global.write_bytes(&mut bytes);
        bytes
    }

    fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        two(bytes).map(|(caustic, global)| Self { caustic, global })
    }

    fn join(&mut self, behind: Self) -> Result<(), String> {
        self.append(behind);
        Ok(())
    }
}

impl Portable for Importons {
    const NAME: &'static str = "importons";

    fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.surfaces.write_bytes(&mut bytes);
        self.emitters.write_bytes(&mut bytes);
        bytes
    }

    fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        two(bytes).map(|(surfaces, emitters)| Self { surfaces, emitters })
    }

    fn join(&mut self, behind: Self) -> Result<(), String> {
        self.append(behind);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use photon_map::Photon;

    #[test]
    fn maps_come_back_and_other_bytes_are_refused() {
        let mut maps = PhotonMaps::new();
        for (x, caustic) in [(0.1, true), (0.2, false), (0.3, false)] {
            let mut photon = Photon::new([x, 0.0, 1.0], [0.0, 0.6, 0.8], [x, 2.0, 3.0]);
            photon.caustic = caustic;
            maps.store(photon);
        }
        let mut bytes = maps.to_bytes();
        assert_eq!(bytes.len(), 2 * 24 + 3 * 32);
        let mut twice = PhotonMaps::from_bytes(&bytes).unwrap();
        twice.join(maps.clone()).unwrap();
        assert_eq!((twice.caustic.len(), twice.global.len()), (2, 4));
        assert_eq!(&twice.global.as_slice()[..2], maps.global.as_slice());
        assert!(PhotonMaps::from_bytes(&bytes[1..]).is_err());
        bytes.push(0);
        assert!(PhotonMaps::from_bytes(&bytes).unwrap_err().contains("1 bytes too many"));
    }
}
