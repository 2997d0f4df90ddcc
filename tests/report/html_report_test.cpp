#include "report/html_report.h"

#include <catch2/catch.hpp>
#include <regex>

#include "core/atomic_file.h"
#include "support/paths.h"

using namespace alabaster;

namespace {

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

HtmlReport example() {
  HtmlReport report("Planar <laboratory>", "What & why");
  report.heading("First");
  report.paragraph("1 < 2");
  const auto handles = report.images({{Pixels8(4, 3, 3), "reference", "Stripes, lit in the middle"},
                                      {Pixels8(4, 3, 3), "composite", ""},
                                      {Pixels8(4, 3, 4), "factorized \"f\"", ""}});
  report.slider(handles, "Any two");
  report.heading("Second");
  report.table({"Errors", {"model", "bias"}, {{"composite", "0.05"}, {"a<b", "0.1"}}, {1, 0}});
  report.chart({"Pareto", "s", "error", true, true, {{"m", {1, 2}, {3, 4}}}}, "Error falls with time");
  report.list({"one", "two"});
  return report;
}

}  // namespace

TEST_CASE("base64 by the test vectors of RFC 4648") {
  const std::vector<std::pair<std::string, std::string>> vectors{
      {"", ""}, {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foob", "Zm9vYg=="}, {"foobar", "Zm9vYmFy"}};
  for (const auto& [plain, encoded] : vectors) CHECK(base64(plain.data(), plain.size()) == encoded);
}

TEST_CASE("a report is one file that fetches nothing and escapes what it is given") {
  const std::string html = example().html();
  CHECK(html.find("<title>Planar &lt;laboratory&gt;</title>") != std::string::npos);
  CHECK(html.find("a&lt;b") != std::string::npos);
  CHECK(html.find("factorized &quot;f&quot;") != std::string::npos);
  const std::regex outside(R"re((src|href)="(?!data:|#))re");
  CHECK_FALSE(std::regex_search(html, outside));
  CHECK(html.find("http") == std::string::npos);
}

TEST_CASE("the best cell of a row is emphasised") {
  const std::string html = example().html();
  CHECK(count(html, "<strong>") == 1);
  CHECK(html.find("<td><strong>0.05</strong></td>") != std::string::npos);
}

TEST_CASE("every picture has an alternative text and every control a label") {
  const std::string html = example().html();
  CHECK(count(html, "<img") == count(html, " alt=\""));
  CHECK(html.find("alt=\"Stripes, lit in the middle\"") != std::string::npos);
  CHECK(count(html, "<select id=") + count(html, "<input id=") == count(html, "<label for="));
  CHECK(count(html, "<option") == 6);
  CHECK(html.find("@media print") != std::string::npos);
  CHECK(html.find("<html lang=\"en\">") != std::string::npos);
  CHECK(count(html, "<li><a href=\"#section-") == 2);
}

TEST_CASE("the tags of a report close in order") {
  const std::string html = example().html();
  const std::size_t body = html.find("<body>");
  std::string text = html.substr(body, html.find("<script>") - body) + "</body>";
  std::vector<std::string> open;
  // By hand: std::regex recurses over every character of an embedded picture.
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at + 1)) {
    const bool closing = text[at + 1] == '/';
    const std::size_t begin = at + (closing ? 2 : 1), end = text.find_first_of(" \n/>", begin);
    const std::string name = text.substr(begin, end - begin);
    REQUIRE_FALSE(name.empty());
    if (name == "img" || name == "input") continue;
    if (!closing) {
      open.push_back(name);
    } else {
      REQUIRE_FALSE(open.empty());
      CHECK(open.back() == name);
      open.pop_back();
    }
  }
  CHECK(open.empty());
}

TEST_CASE("a report is written whole") {
  const ScratchFolder folder;
  example().write(folder / "a/b.html");
  CHECK(read_text(folder / "a/b.html") == example().html());
}
