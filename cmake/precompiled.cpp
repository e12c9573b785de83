// A library needs a file; what precompiled.hpp declares is compiled in json.cpp.
