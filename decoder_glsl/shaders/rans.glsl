// The entropy decoder of FORMAT.md 3.3: range asymmetric numeral systems (rANS), one stream per
// invocation.
#ifndef TSR_RANS
#define TSR_RANS
#include "buffers.glsl"

struct TsrRans {
    uint state;
    uint at;   // byte of the next word, in the payload area
    uint left; // 16-bit words that remain
};

void tsr_refill(TSR_INOUT(TsrRans) r) {
    if (r.state < 0x10000u && r.left > 0u) {
        r.state = (r.state << 16) | tsr_payload_word(r.at);
        r.at += 2u;
        r.left -= 1u;
    }
}

// The stream ends with the payload area, whatever size its record gives.
TsrRans tsr_begin(uint byte_at, uint words) {
    TsrRans r;
    r.state = 0u;
    r.at = byte_at;
    uint bytes = tsr_header(tsr_b_payload_bytes);
    uint there = byte_at < bytes ? (bytes - byte_at) / 2u : 0u;
    r.left = min(words, there);
    tsr_refill(r);
    tsr_refill(r);
    return r;
}

bool tsr_ended_well(TsrRans r) {
    return r.state == 0u && r.left == 0u;
}

void tsr_consume(TSR_INOUT(TsrRans) r, uint start, uint end) {
    r.state = (end - start) * (r.state >> 12) + (r.state & 4095u) - start;
    tsr_refill(r);
}

// Decodes one bit, whose 0 has frequency `zero` of 4,096.
bool tsr_bit(TSR_INOUT(TsrRans) r, uint zero) {
    bool one = (r.state & 4095u) >= zero;
    tsr_consume(r, one ? zero : 0u, one ? 4096u : zero);
    return one;
}

// Decodes `count` equiprobable bits, 0..16.
uint tsr_raw(TSR_INOUT(TsrRans) r, int count) {
    uint value = r.state & ((1u << uint(count)) - 1u);
    r.state >>= uint(count);
    tsr_refill(r);
    return value;
}

struct TsrSymbol {
    int index;
    uint start;
    uint end;
};

// The symbol of a table before any of its starts is compared with the slot.
TsrSymbol tsr_first_symbol() {
    TsrSymbol s;
    s.index = 0;
    s.start = 0u;
    s.end = 4096u;
    return s;
}

// Compares two starts of a table with the slot. Starts ascend: the last one at or below the slot
// begins the symbol, and the first one above the slot ends it.
void tsr_two_starts(uint pair, uint slot, TSR_INOUT(TsrSymbol) s) {
    uint a = pair & 0xFFFFu;
    uint b = pair >> 16;
    if (slot >= b) {
        s.index += 2;
        s.start = b;
    } else if (slot >= a) {
        s.index += 1;
        s.start = a;
        s.end = min(s.end, b);
    } else {
        s.end = min(s.end, a);
    }
}

// Decodes a symbol with the table at `at`. Most symbols are among the first few, so the other
// starts are read only when they are needed.
int tsr_symbol(TSR_INOUT(TsrRans) r, uint at) {
    uint slot = r.state & 4095u;
    TsrSymbol s = tsr_first_symbol();
    tsr_two_starts(tsr_table(at), slot, s);
    tsr_two_starts(tsr_table(at + 1u), slot, s);
    if (s.index == 4) {
        tsr_two_starts(tsr_table(at + 2u), slot, s);
        tsr_two_starts(tsr_table(at + 3u), slot, s);
        tsr_two_starts(tsr_table(at + 4u), slot, s);
        tsr_two_starts(tsr_table(at + 5u), slot, s);
    }
    if (s.index == 12) {
        tsr_two_starts(tsr_table(at + 6u), slot, s);
        tsr_two_starts(tsr_table(at + 7u), slot, s);
        tsr_two_starts(tsr_table(at + 8u), slot, s);
        tsr_two_starts(tsr_table(at + 9u), slot, s);
        tsr_two_starts(tsr_table(at + 10u), slot, s);
        tsr_two_starts(tsr_table(at + 11u), slot, s);
    }
    tsr_consume(r, s.start, s.end);
    return s.index;
}

// Decodes one of up to three symbols, whose table is one word.
int tsr_symbol3(TSR_INOUT(TsrRans) r, uint at) {
    TsrSymbol s = tsr_first_symbol();
    tsr_two_starts(tsr_table(at), r.state & 4095u, s);
    tsr_consume(r, s.start, s.end);
    return s.index;
}

// Decodes one of up to five symbols, whose table is two words.
int tsr_symbol5(TSR_INOUT(TsrRans) r, uint at) {
    uint slot = r.state & 4095u;
    TsrSymbol s = tsr_first_symbol();
    tsr_two_starts(tsr_table(at), slot, s);
    tsr_two_starts(tsr_table(at + 1u), slot, s);
    tsr_consume(r, s.start, s.end);
    return s.index;
}

// Decodes one of up to seven symbols, whose table is three words.
int tsr_symbol7(TSR_INOUT(TsrRans) r, uint at) {
    uint slot = r.state & 4095u;
    TsrSymbol s = tsr_first_symbol();
    tsr_two_starts(tsr_table(at), slot, s);
    tsr_two_starts(tsr_table(at + 1u), slot, s);
    tsr_two_starts(tsr_table(at + 2u), slot, s);
    tsr_consume(r, s.start, s.end);
    return s.index;
}

// Decodes the raw bits behind a token and returns the magnitude, 1..2^21 (FORMAT.md 3.4).
uint tsr_magnitude(TSR_INOUT(TsrRans) r, int token) {
    if (token < 4)
        return uint(token) + 1u;
    int group = token - 3;
    uint high = group > 16 ? tsr_raw(r, group - 16) : 0u;
    uint low = tsr_raw(r, min(group, 16));
    return (1u << uint(group)) + (high << 16) + low + 3u;
}

#endif
