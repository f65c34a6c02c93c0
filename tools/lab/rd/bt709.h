// Y Cb Cr of ITU-R BT.709. Cb and Cr are centred on 0.
#pragma once

namespace tessera {

template <class Real> struct Bt709 { Real y, cb, cr; };

template <class Real> Bt709<Real> to_bt709(Real r, Real g, Real b) {
    const Real y = Real(0.2126) * r + Real(0.7152) * g + Real(0.0722) * b;
    return {y, (b - y) / Real(1.8556), (r - y) / Real(1.5748)};
}

template <class Real> struct Rgb { Real r, g, b; };

template <class Real> Rgb<Real> from_bt709(Real y, Real cb, Real cr) {
    const Real r = y + Real(1.5748) * cr, b = y + Real(1.8556) * cb;
    return {r, (y - Real(0.2126) * r - Real(0.0722) * b) / Real(0.7152), b};
}

} // namespace tessera
