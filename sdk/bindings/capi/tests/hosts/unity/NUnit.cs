// Stubs: the parts of NUnit that the tests of the package use, and a program that runs the tests of the assemblies that it is given.
using System;
using System.Collections;
using System.Linq;
using System.Reflection;
using UnityEngine;
using UnityEngine.TestTools;

namespace NUnit.Framework
{
    public sealed class TestAttribute : Attribute
    {
    }

    public sealed class TearDownAttribute : Attribute
    {
    }

    public delegate void TestDelegate();

    public static class Assert
    {
        public static void IsTrue(bool condition)
        {
            if (!condition)
                throw new Exception("not true");
        }

        public static void IsNull(object value)
        {
            AreEqual(null, value);
        }

        public static void AreEqual(object expected, object actual)
        {
            IEnumerable wanted = expected as IEnumerable, there = actual as IEnumerable;
            bool are = wanted != null && there != null ? wanted.Cast<object>().SequenceEqual(there.Cast<object>()) : Equals(expected, actual);
            if (!are)
                throw new Exception("expected " + expected + ", not " + actual);
        }

        public static T Throws<T>(TestDelegate code) where T : Exception
        {
            try
            {
                code();
            }
            catch (T error)
            {
                return error;
            }
            throw new Exception("no " + typeof(T).Name);
        }

        public static void Ignore(string message)
        {
            throw new Exception("ignored: " + message);
        }
    }
}

static class Program
{
    static MethodInfo[] With(Type type, Type attribute)
    {
        return type.GetMethods().Where(method => method.IsDefined(attribute, false)).ToArray();
    }

    /// Whether a test passes, with the errors that it expects and no other.
    static bool Passes(Type type, MethodInfo test)
    {
        var fixture = Activator.CreateInstance(type);
        int before = Debug.Errors;
        try
        {
            test.Invoke(fixture, null);
            foreach (var end in With(type, typeof(NUnit.Framework.TearDownAttribute)))
                end.Invoke(fixture, null);
        }
        catch (TargetInvocationException error)
        {
            Console.Error.WriteLine(test.Name + ": " + error.InnerException);
            return false;
        }
        return Debug.Errors == before && LogAssert.IsMet;
    }

    static int Main(string[] assemblies)
    {
        int failed = 0;
        var loaded = assemblies.Select(Assembly.LoadFrom).ToArray();
        foreach (var type in loaded.SelectMany(assembly => assembly.GetTypes()))
            foreach (var test in With(type, typeof(NUnit.Framework.TestAttribute)))
            {
                bool passes = Passes(type, test);
                Console.WriteLine((passes ? "passed " : "failed ") + type.FullName + "." + test.Name);
                failed += passes ? 0 : 1;
            }
        return failed;
    }
}
