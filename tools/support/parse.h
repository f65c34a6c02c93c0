// Strict conversion of text from the command line and from file headers to numbers.
#pragma once

#include "format/status.h"
#include "format/texture.h"

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <string_view>

namespace tessera {

// Parses "512x256x32x32". Errors: bad_argument, with the text.
Result<Extent4> parse_extent(std::string_view text);
// `text` of `option`, parsed; `usual` if it is empty. Errors: those of parse_extent, with the
// option.
Result<Extent4> parse_extent_or(const std::string& text, const char* option, const Extent4& usual);

// Parses "u0:u1,v0:v1,s0:s1,t0:t1", half-open ranges. A missing number is the end of the axis, so
// ":" is a whole axis. Errors: bad_argument, also if the box is empty or not inside `whole`.
Result<Box4> parse_box(std::string_view text, const Extent4& whole);

// Parses the whole text, without blanks around it. False if it is not a number.
bool parse_number(std::string_view text, std::uint64_t& out);
bool parse_number(std::string_view text, double& out);
// Parses exactly out.size() numbers with commas between them. False if the text is anything else.
bool parse_numbers(std::string_view text, std::span<double> out);

// Parses "10,0,-2.5". Errors: bad_argument, with the text.
Status parse_point(std::string_view text, glm::dvec3& out);

// Parses "8" or "unorm8"; "16f", "half" or "half16".
Result<SampleType> parse_sample_type(std::string_view text);
const char* name_of(SampleType type);
const char* channel_name(unsigned channels, unsigned c); // "R", "G", "B", "A" or "Y", "A"

// Makes text from outside safe for a terminal: control characters become spaces.
std::string printable(std::string text);

std::string human_bytes(std::uint64_t bytes); // "402.7 MB", powers of 1000
std::string format_number(double value, int decimals);
std::string format_digits(double value, int digits); // at most so many significant ones

} // namespace tessera
