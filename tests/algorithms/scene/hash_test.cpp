#include "algorithms/scene/files/hash.hpp"

#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "tests/algorithms/scene/folder_test.hpp"

namespace pellucid {
namespace {

TEST(Sha256, AgreesWithTheStandardsExamples) {  // FIPS 180-2, appendix B
  EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

TEST(Sha256, PiecesAreKeptApart) {
  const auto of = [](std::string_view a, std::string_view b) {
    Sha256 hash;
    hash.add(a);
    hash.add(b);
    return hash.hex();
  };
  EXPECT_NE(of("ab", "c"), of("a", "bc"));
  EXPECT_NE(of("abc", ""), of("", "abc"));
  EXPECT_EQ(of("ab", "c"), of("ab", "c"));
}

class HashFile : public test::FolderTest {};

TEST_F(HashFile, IsThatOfItsContent) {
  const std::string content(200'001, 'x');
  EXPECT_EQ(sha256_file(write("a", content)), sha256_hex(content));
  EXPECT_EQ(sha256_file(write("e", "")), sha256_hex(""));
  EXPECT_EQ(test::message_of([&] { sha256_file(file("none")); }),
            "cannot read '" + file("none").string() + "': No such file or directory");
}

}  // namespace
}  // namespace pellucid
