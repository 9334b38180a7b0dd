// Reports and the words of a command line.
#include <support/arguments.h>
#include <support/report.h>
#include <support/tool.h>

#include <catch2/catch.hpp>

#include <array>
#include <limits>

using namespace haarlight;

namespace {

int run(
    std::vector<const char*> words, int& size, std::vector<double>& colour,
    const std::function<int()>& body = [] { return 0; }) {
  tool::Tool app("probe", "Tests.");
  app.value(size, "-s,--size", "pixels", 1, 10);
  app.values(colour, "--colour", "a colour", 3, 0, 1);
  words.insert(words.begin(), "probe");
  return app.run(static_cast<int>(words.size()), words.data(), body);
}

} // namespace

TEST_CASE("a report is aligned text or one JSON object", "[support]") {
  tool::Report report;
  report.add("size", 3, "px").add("long_name", 0.5).add("good", true).add("text", "a\"b");
  report.section("part").add("inner", std::vector<double>{1, 2.5});
  report.row("rows").add("i", 1).add("bytes", std::uint64_t{1234});
  report.row("rows").add("i", 20).add("bytes", std::uint64_t{5});
  CHECK(report.text() == "size       3 px\n"
                         "long name  0.5\n"
                         "good       yes\n"
                         "text       a\"b\n"
                         "part\n"
                         "  inner  1 2.5\n"
                         "rows\n"
                         "   i  bytes\n"
                         "   1   1234\n"
                         "  20      5\n");
  CHECK(report.json() == "{\n  \"size\": 3,\n  \"long_name\": 0.5,\n  \"good\": true,\n"
                         "  \"text\": \"a\\\"b\",\n  \"part\": {\n    \"inner\": [\n      1.0,\n"
                         "      2.5\n    ]\n  },\n  \"rows\": [\n    {\n      \"i\": 1,\n"
                         "      \"bytes\": 1234\n    },\n    {\n      \"i\": 20,\n"
                         "      \"bytes\": 5\n    }\n  ]\n}\n");
}

TEST_CASE("what is not finite or no UTF-8 still gives JSON", "[support]") {
  tool::Report report;
  report.add("x", std::numeric_limits<double>::infinity()).add("name", "\xff");
  CHECK(report.json() == "{\n  \"x\": null,\n  \"name\": \"\xef\xbf\xbd\"\n}\n");
}

TEST_CASE("numbers are read strictly", "[support]") {
  CHECK(tool::parse_integer("-12", -20, 5) == -12);
  CHECK(tool::parse_number("1e-3", 0, 1) == 0.001);
  CHECK(tool::parse_numbers("1,0.5,0", 3, 0, 1) == std::vector<double>{1, 0.5, 0});
  for (const char* word : {"", "x", "1x", " 1", "1.5", "99999999999999999999", "6", "+1", "0x1"})
    CHECK_THROWS_AS(tool::parse_integer(word, -20, 5), tool::UsageError);
  for (const char* word : {"", "nan", "inf", "-inf", "1e999", "2", "-0.1", "0,5"})
    CHECK_THROWS_AS(tool::parse_number(word, 0, 1), tool::UsageError);
  for (const char* word : {"", "1,1", "1,1,1,1", "1,,1", "1,1,2", "1,1,"})
    CHECK_THROWS_AS(tool::parse_numbers(word, 3, 0, 1), tool::UsageError);
  CHECK(tool::size_text(1536) == "1.50 KiB");
}

TEST_CASE("options reach their variables, errors become exit codes", "[support]") {
  int size = 4;
  std::vector<double> colour = {0, 0, 0};
  CHECK(run({"--size", "7", "--colour", "1,0,0.5"}, size, colour) == 0);
  CHECK(size == 7);
  CHECK(colour == std::vector<double>{1, 0, 0.5});
  CHECK(run({"--size", "11"}, size, colour) == tool::exit_usage);
  CHECK(run({"--what"}, size, colour) == tool::exit_usage);
  CHECK(run({"surplus"}, size, colour) == tool::exit_usage);
  CHECK(run({}, size, colour, [] { return tool::exit_no; }) == tool::exit_no);
  CHECK(run({}, size, colour, []() -> int { throw tool::UsageError("x"); }) == tool::exit_usage);
  CHECK(run({}, size, colour, []() -> int { throw std::bad_alloc(); }) == tool::exit_internal);
  CHECK(run({}, size, colour, []() -> int { throw std::logic_error("x"); }) == tool::exit_internal);
}
